//! What was done, but not as asked: structured and counted, one entry a kind.

use std::fmt;

/// Warnings of one act, in order of first appearance.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Warnings {
    entries: Vec<Warning>,
}

/// One kind of warning with its count.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What happened.
    pub kind: WarningKind,
    /// How often.
    pub count: u64,
}

/// What can be done otherwise than asked while loading and estimating.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum WarningKind {
    /// Surfels whose position was NaN or infinite; dropped, with the faces that used them.
    NonFinitePositionsDropped,
    /// Normals that were NaN, infinite or zero; computed from faces or neighbours instead.
    UnusableNormalsReplaced,
    /// Radii that were NaN, infinite or negative; computed from faces or neighbours instead.
    UnusableRadiiReplaced,
    /// Tangent axes that were NaN, infinite or parallel; the axes of all surfels were left out.
    UnusableAxesIgnored,
    /// Faces that indexed past the end of the vertices, or used a dropped one; dropped.
    FacesOutOfRangeDropped,
    /// Faces with fewer than three different corners; dropped.
    DegenerateFacesDropped,
    /// Polygons that are not convex or not flat; cut into triangles by ear clipping.
    NonConvexPolygonsCut,
    /// Polygons with holes; the holes were filled.
    PolygonHolesFilled,
    /// Vertices of a mesh that no face uses; their radii came from their neighbours.
    IsolatedVertices,
    /// The mesh is wound inward (negative volume); normals point inside until it is flipped.
    WoundInward,
    /// The mesh was flipped, as asked; its winding and its normals were reversed.
    Flipped,
    /// Vertices without a z property; z was taken as 0.
    NoZ,
    /// Surfels whose normals were estimated from neighbours; their sign is arbitrary.
    NormalsEstimated,
    /// Surfels whose normals were brought to one side all over the object.
    NormalsOriented,
    /// Pieces of an object that no neighbours connect; the normals of each were oriented for itself.
    OrientedInPieces,
    /// Surfels whose radii were estimated from neighbours.
    RadiiEstimated,
    /// Surfels whose tangent axes were estimated from neighbours.
    AxesEstimated,
    /// All surfels lie at one place, so there is no distance to take a radius from.
    AllAtOnePlace,
    /// List properties of vertices, which no column can hold; skipped.
    ListPropertySkipped(String),
    /// Bytes after the last element; ignored.
    TrailingBytesIgnored,
    /// Elements that no surfel or face came from; skipped.
    ElementSkipped(String),
    /// Anything else, said in words; the text stands behind the count.
    Other(String),
}

impl Warnings {
    /// No warnings.
    pub fn new() -> Self {
        Self::default()
    }

    /// Counts `count` more of `kind`; 0 changes nothing.
    pub fn add(&mut self, kind: WarningKind, count: u64) {
        if count == 0 {
            return;
        }
        if let Some(entry) = self.entries.iter_mut().find(|entry| entry.kind == kind) {
            entry.count += count;
        } else {
            self.entries.push(Warning { kind, count });
        }
    }

    /// Takes over the warnings of a part of the act.
    pub fn merge(&mut self, other: Self) {
        for Warning { kind, count } in other.entries {
            self.add(kind, count);
        }
    }

    /// How often `kind` was counted.
    pub fn count(&self, kind: &WarningKind) -> u64 {
        self.entries
            .iter()
            .find(|entry| entry.kind == *kind)
            .map_or(0, |entry| entry.count)
    }

    /// True when all went as asked.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// The warnings, in order of first appearance.
    pub fn iter(&self) -> impl Iterator<Item = &Warning> {
        self.entries.iter()
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { kind, count: n } = self;
        let s = if *n == 1 { "" } else { "s" };
        match kind {
            WarningKind::NonFinitePositionsDropped => {
                write!(f, "{n} surfel{s} with NaN or infinite coordinates dropped")
            }
            WarningKind::UnusableNormalsReplaced => {
                write!(
                    f,
                    "{n} surfel{s} with NaN or zero normals: normals computed instead"
                )
            }
            WarningKind::UnusableRadiiReplaced => {
                write!(
                    f,
                    "{n} surfel{s} with NaN or negative radii: radii computed instead"
                )
            }
            WarningKind::UnusableAxesIgnored => {
                write!(
                    f,
                    "{n} surfel{s} with NaN or parallel tangent axes: all axes ignored, drawn as disks"
                )
            }
            WarningKind::FacesOutOfRangeDropped => {
                write!(
                    f,
                    "{n} face{s} with corners that do not exist or were dropped: dropped"
                )
            }
            WarningKind::DegenerateFacesDropped => write!(
                f,
                "{n} face{s} with fewer than three different corners dropped"
            ),
            WarningKind::NonConvexPolygonsCut => write!(
                f,
                "{n} polygon{s} not convex: cut into triangles by clipping ears"
            ),
            WarningKind::PolygonHolesFilled => write!(f, "{n} polygon{s} with holes: holes filled"),
            WarningKind::IsolatedVertices => {
                write!(
                    f,
                    "{n} vert{} that no face uses: radius from the neighbours",
                    if *n == 1 { "ex" } else { "ices" }
                )
            }
            WarningKind::WoundInward => {
                write!(
                    f,
                    "the mesh is wound inward, its normals point inside; flip it to light it from outside"
                )
            }
            WarningKind::Flipped => write!(f, "winding and normals flipped, as asked"),
            WarningKind::NoZ => write!(f, "vertices have no z: taken as 0"),
            WarningKind::NormalsEstimated => {
                write!(
                    f,
                    "{n} normal{s} estimated from neighbours; their sign is arbitrary, lit from both sides"
                )
            }
            WarningKind::NormalsOriented => {
                write!(f, "{n} normal{s} oriented to one side, outward")
            }
            WarningKind::OrientedInPieces => write!(
                f,
                "no neighbours connect the object's {n} pieces: each was oriented for itself"
            ),
            WarningKind::AxesEstimated => {
                write!(f, "{n} pair{s} of tangent axes estimated from neighbours")
            }
            WarningKind::RadiiEstimated => write!(
                f,
                "{n} radi{} estimated from neighbours",
                if *n == 1 { "us" } else { "i" }
            ),
            WarningKind::AllAtOnePlace => write!(f, "all {n} surfel{s} lie at one place"),
            WarningKind::ListPropertySkipped(name) => {
                write!(f, "list property '{name}' of the vertices skipped")
            }
            WarningKind::TrailingBytesIgnored => {
                write!(f, "{n} byte{s} after the last element ignored")
            }
            WarningKind::ElementSkipped(name) => {
                write!(f, "element '{name}' with {n} row{s} skipped")
            }
            WarningKind::Other(text) if *n == 1 => f.write_str(text),
            WarningKind::Other(text) => write!(f, "{text} ({n} times)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_kind_is_one_line_with_its_count() {
        let mut warnings = Warnings::new();
        warnings.add(WarningKind::NonFinitePositionsDropped, 200);
        warnings.add(WarningKind::NonFinitePositionsDropped, 14);
        warnings.add(WarningKind::NoZ, 0);
        let lines: Vec<String> = warnings.iter().map(ToString::to_string).collect();
        assert_eq!(
            lines,
            ["214 surfels with NaN or infinite coordinates dropped"]
        );
    }
}
