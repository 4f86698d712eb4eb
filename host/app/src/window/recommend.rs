//! Which renderer suits a scene best, for the still picture and for the moving one, and why: a rule, not a taste.
//!
//! What a renderer *needs* of a scene, it uses; so of the renderers that can draw the scene, the one whose needs take up
//! most of what the scene has is recommended for the still picture, and the one that needs least for the moving one.
//! Renderers on the CPU come last where there is a device.

use pointstage_plugin_api::manifest::{DeviceKind, Gives, Needs};
use pointstage_scene::{Provenance, Scene};

/// A renderer that may be recommended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Candidate<'a> {
    /// What a request names.
    pub(crate) id: &'a str,
    /// What it cannot do without.
    pub(crate) needs: &'a Needs,
    /// What it offers.
    pub(crate) gives: &'a Gives,
    /// Whether it can draw the scene on the device that there is.
    pub(crate) is_suitable: bool,
}

/// A renderer, and one sentence why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Recommendation {
    /// The renderer's id.
    pub(crate) id: String,
    /// Begins with a verb: `uses the normals and radii that this scene has`.
    pub(crate) why: String,
}

/// What a scene has that renderers may use. All objects that have surfels must have it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Has {
    normals: bool,
    radii: bool,
    axes: bool,
    colours: bool,
    mesh: bool,
}

impl Has {
    /// What `scene` has; `None` if it is empty, since nothing suits an empty scene best.
    pub(crate) fn of(scene: &Scene) -> Option<Self> {
        let mut filled = scene
            .objects()
            .iter()
            .map(|object| &*object.geometry)
            .filter(|geometry| geometry.surfel_count > 0)
            .peekable();
        filled.peek()?;
        let all = Self {
            normals: true,
            radii: true,
            axes: true,
            colours: true,
            mesh: true,
        };
        let given = |provenance| provenance != Provenance::Missing;
        Some(filled.fold(all, |has, geometry| {
            let origins = &geometry.origins;
            Self {
                normals: has.normals && given(origins.normals),
                radii: has.radii && given(origins.radii),
                axes: has.axes && given(origins.axes),
                colours: has.colours && given(origins.colours),
                mesh: has.mesh && geometry.triangle_count() > 0,
            }
        }))
    }
}

/// What a renderer uses, by name, with how much each says about the shape of a surface: an ellipse says more than a
/// circle, a normal as much as a radius; colours change no shape.
fn used(needs: &Needs) -> Vec<(&'static str, u32)> {
    let all = [
        (needs.normals, "normals", 2),
        (needs.radii, "radii", 2),
        (needs.axes, "tangent axes", 3),
        (needs.mesh, "triangles", 2),
        (needs.colours, "colours", 1),
    ];
    let used = all.into_iter().filter(|(is_used, ..)| *is_used);
    used.map(|(_, name, weight)| (name, weight)).collect()
}

fn weight(needs: &Needs) -> u32 {
    let columns = needs.columns.len() as u32;
    used(needs).iter().map(|(_, weight)| weight).sum::<u32>() + columns
}

/// Suitable candidates: those that draw on the device, or all if there is none of them.
fn suitable<'a>(candidates: &[Candidate<'a>]) -> Vec<Candidate<'a>> {
    let suitable = candidates.iter().filter(|candidate| candidate.is_suitable);
    let (on_device, on_cpu): (Vec<_>, Vec<_>) =
        suitable.partition(|candidate| candidate.needs.device == DeviceKind::Gpu);
    if on_device.is_empty() {
        on_cpu
    } else {
        on_device
    }
}

/// The renderer for the still picture; of equals the first. `None` for an empty scene, or if none can draw it.
pub(crate) fn main(candidates: &[Candidate<'_>], has: Option<Has>) -> Option<Recommendation> {
    let has = has?;
    let suitable = suitable(candidates);
    // `max_by_key` takes the last of equals.
    let best = suitable
        .iter()
        .rev()
        .max_by_key(|candidate| weight(candidate.needs))?;
    let mut names: Vec<String> = used(best.needs)
        .into_iter()
        .map(|(name, _)| name.to_owned())
        .collect();
    names.extend(best.needs.columns.iter().map(|name| format!("'{name}'")));
    let why = if names.is_empty() {
        positions_only(has)
    } else {
        format!("uses the {} that this scene has", listed(&names))
    };
    Some(Recommendation {
        id: best.id.to_owned(),
        why: with_device(why, best),
    })
}

/// The renderer for the moving picture, if another one than the still picture's needs less; of equals the first.
pub(crate) fn preview(candidates: &[Candidate<'_>], has: Option<Has>) -> Option<Recommendation> {
    has?;
    let suitable = suitable(candidates);
    // One that refines has not finished its picture when the next is due.
    let fastest = suitable
        .iter()
        .min_by_key(|candidate| (candidate.gives.progressive, weight(candidate.needs)))?;
    let names: Vec<String> = used(fastest.needs)
        .into_iter()
        .map(|(name, _)| name.to_owned())
        .collect();
    let why = if names.is_empty() {
        "fastest: needs positions only".to_owned()
    } else {
        format!("fastest: needs only {}", listed(&names))
    };
    Some(Recommendation {
        id: fastest.id.to_owned(),
        why: with_device(why, fastest),
    })
}

fn positions_only(has: Has) -> String {
    if has.normals || has.radii || has.axes {
        "draws the positions; no renderer here needs more".to_owned()
    } else {
        "draws the positions, all that this scene has".to_owned()
    }
}

fn with_device(why: String, chosen: &Candidate<'_>) -> String {
    match chosen.needs.device {
        DeviceKind::Gpu => why,
        DeviceKind::Cpu => format!("{why}, and needs no graphics device"),
    }
}

/// `a`, `a and b`, `a, b and c`.
fn listed(names: &[String]) -> String {
    match names {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const EVERYTHING: Has = Has {
        normals: true,
        radii: true,
        axes: true,
        colours: true,
        mesh: true,
    };
    const NOTHING: Has = Has {
        normals: false,
        radii: false,
        axes: false,
        colours: false,
        mesh: false,
    };

    fn gpu(change: impl FnOnce(&mut Needs)) -> Needs {
        let mut needs = Needs::default();
        change(&mut needs);
        needs
    }

    fn cpu() -> Needs {
        gpu(|needs| needs.device = DeviceKind::Cpu)
    }

    /// Candidates `a`, `b`, … of these needs; the flags say whether they are suitable.
    fn asked(needs: &[(Needs, bool)], has: Has) -> [Option<(String, String)>; 2] {
        let gives = Gives::default();
        let candidates: Vec<Candidate<'_>> = needs
            .iter()
            .zip(["a", "b", "c", "d"])
            .map(|((needs, is_suitable), id)| Candidate {
                id,
                needs,
                gives: &gives,
                is_suitable: *is_suitable,
            })
            .collect();
        [
            main(&candidates, Some(has)),
            preview(&candidates, Some(has)),
        ]
        .map(|found| found.map(|found| (found.id, found.why)))
    }

    fn is(id: &str, why: &str) -> Option<(String, String)> {
        Some((id.to_owned(), why.to_owned()))
    }

    #[test]
    fn what_uses_most_of_the_scene_is_recommended_and_what_needs_least_previews() {
        let points = gpu(|_| ());
        let disks = gpu(|needs| needs.radii = true);
        let splats = gpu(|needs| (needs.normals, needs.radii) = (true, true));
        let found = asked(&[(points, true), (splats, true), (disks, true)], EVERYTHING);
        assert_eq!(
            found,
            [
                is("b", "uses the normals and radii that this scene has"),
                is("a", "fastest: needs positions only")
            ]
        );
    }

    #[test]
    fn what_cannot_draw_the_scene_is_not_recommended() {
        let points = gpu(|_| ());
        let splats = gpu(|needs| (needs.normals, needs.radii) = (true, true));
        let found = asked(&[(splats, false), (points, true)], NOTHING);
        assert_eq!(
            found[0],
            is("b", "draws the positions, all that this scene has")
        );
        assert_eq!(asked(&[(cpu(), false)], NOTHING), [None, None]);
    }

    #[test]
    fn the_cpu_is_for_sessions_without_a_device() {
        let reference = gpu(|needs| {
            (needs.device, needs.axes, needs.radii) = (DeviceKind::Cpu, true, true);
        });
        let disks = gpu(|needs| needs.radii = true);
        let with_device = [(reference.clone(), true), (disks.clone(), true)];
        assert_eq!(
            asked(&with_device, EVERYTHING)[0],
            is("b", "uses the radii that this scene has")
        );
        let without = [(reference, true), (disks, false), (cpu(), true)];
        assert_eq!(
            asked(&without, EVERYTHING)[0],
            is(
                "a",
                "uses the radii and tangent axes that this scene has, and needs no graphics device"
            )
        );
    }

    #[test]
    fn a_renderer_that_refines_is_no_preview() {
        let (points, disks) = (gpu(|_| ()), gpu(|needs| needs.radii = true));
        let refines = Gives {
            progressive: true,
            ..Gives::default()
        };
        let steady = Gives::default();
        let candidate = |id, needs, gives| Candidate {
            id,
            needs,
            gives,
            is_suitable: true,
        };
        let candidates = [
            candidate("slow", &points, &refines),
            candidate("steady", &disks, &steady),
        ];
        let found = preview(&candidates, Some(EVERYTHING)).expect("two can draw");
        assert_eq!(
            (&*found.id, &*found.why),
            ("steady", "fastest: needs only radii")
        );
    }

    #[test]
    fn of_equals_the_first_is_recommended_and_nothing_for_an_empty_scene() {
        let points = gpu(|_| ());
        let found = asked(&[(points.clone(), true), (points.clone(), true)], NOTHING);
        assert_eq!(
            found.map(|found| found.map(|(id, _)| id)),
            [Some("a".to_owned()), Some("a".to_owned())]
        );
        assert_eq!(Has::of(&Scene::new()), None);
        assert_eq!(main(&[], Has::of(&Scene::new())), None);
    }
}
