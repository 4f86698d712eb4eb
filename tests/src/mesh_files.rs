//! Files of every format of meshes and points, all of one mesh with normals and made-up colours.
//!
//! Each is written in the plainest way that its format has, so that every reader knows it.

use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use bytemuck::cast_slice;
use pointstage_plugin_api::columns::decode_normal;
use pointstage_scene::Object;
use serde_json::json;

/// What is written.
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    normals: Vec<[f32; 3]>,
    colours: Vec<[u8; 3]>,
    triangles: Vec<[u32; 3]>,
}

type Writer = fn(&Mesh, &mut dyn Write) -> std::io::Result<()>;

/// What follows the stem of each file's name, and its writer.
const WRITERS: [(&str, Writer); 11] = [
    ("_text.ply", ply),
    ("_obj.obj", obj),
    ("_stl.stl", stl),
    ("_text.stl", stl_text),
    ("_off.off", off),
    ("_glb.glb", glb),
    ("_pcd.pcd", pcd),
    ("_xyz.xyz", xyz),
    ("_pts.pts", pts),
    ("_las.las", las),
    ("_tri.tri", tri),
];

/// Writes a mesh in all these formats, as files whose names begin with `stem`; what is there stays.
///
/// # Errors
/// A file cannot be written.
pub fn write_all(mesh: &Mesh, folder: &Path, stem: &str) -> Result<Vec<PathBuf>> {
    let mut files = Vec::new();
    for (ending, write) in WRITERS {
        let path = folder.join(format!("{stem}{ending}"));
        if !path.is_file() {
            let file = File::create(&path).with_context(|| path.display().to_string())?;
            let mut out = BufWriter::with_capacity(1 << 20, file);
            write(mesh, &mut out).and_then(|()| out.flush())?;
        }
        files.push(path);
    }
    Ok(files)
}

impl Mesh {
    /// The vertices of an object that has normals, and its triangles.
    pub fn of(object: &Object) -> Self {
        let blocks = &object.geometry.blocks;
        let centres = blocks.iter().flat_map(|block| block.position_radius.iter());
        let normals = blocks.iter().filter_map(|block| block.normal.as_ref());
        let normals: Vec<[f32; 3]> = normals
            .flat_map(|normals| normals.iter().map(|bits| decode_normal(*bits).to_array()))
            .collect();
        Self {
            positions: centres.map(|[x, y, z, _]| [*x, *y, *z]).collect(),
            colours: normals.iter().copied().map(colour_of).collect(),
            normals,
            triangles: object
                .geometry
                .triangles
                .as_deref()
                .map_or_else(Vec::new, <[_]>::to_vec),
        }
    }

    /// A unit ball of this many rings of vertices, each of twice as many.
    pub fn ball(rings: u32) -> Self {
        use std::f32::consts::PI;
        let around = 2 * rings;
        let place = |ring: u32, step: u32| {
            let (polar, turn) = (
                PI * (ring as f32 + 0.5) / rings as f32,
                2.0 * PI * step as f32 / around as f32,
            );
            let (sine, cosine) = polar.sin_cos();
            [sine * turn.cos(), cosine, sine * turn.sin()]
        };
        let all = (0..rings).flat_map(|ring| (0..around).map(move |step| (ring, step)));
        let normals: Vec<[f32; 3]> = all.map(|(ring, step)| place(ring, step)).collect();
        let mut triangles = Vec::new();
        for ring in 1..rings {
            for step in 0..around {
                let next = (step + 1) % around;
                let [a, b] = [step, next].map(|step| (ring - 1) * around + step);
                let [c, d] = [step, next].map(|step| ring * around + step);
                triangles.extend([[a, b, c], [b, d, c]]);
            }
        }
        Self {
            positions: normals.clone(),
            colours: normals.iter().copied().map(colour_of).collect(),
            normals,
            triangles,
        }
    }

    /// Position, normal and colour of each vertex.
    fn rows(&self) -> impl Iterator<Item = ([f32; 3], [f32; 3], [u8; 3])> {
        let both = self.positions.iter().zip(&self.normals).zip(&self.colours);
        both.map(|((position, normal), colour)| (*position, *normal, *colour))
    }

    /// Positions of each triangle's corners.
    fn corners(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        let place = |corner: u32| self.positions[corner as usize];
        self.triangles.iter().map(move |corners| corners.map(place))
    }
}

/// A vertex's colour is its normal.
fn colour_of(normal: [f32; 3]) -> [u8; 3] {
    normal.map(|value| (127.5 + 127.0 * value) as u8)
}

/// A line for each vertex: `head` and the position.
fn position_rows(mesh: &Mesh, head: &str, out: &mut dyn Write) -> std::io::Result<()> {
    let mut rows = mesh.positions.iter();
    rows.try_for_each(|[x, y, z]| writeln!(out, "{head}{x:.6} {y:.6} {z:.6}"))
}

/// A line for each triangle: `head` and the indices of its vertices, from 0.
fn face_rows(mesh: &Mesh, head: &str, out: &mut dyn Write) -> std::io::Result<()> {
    let mut rows = mesh.triangles.iter();
    rows.try_for_each(|[a, b, c]| writeln!(out, "{head}{a} {b} {c}"))
}

fn ply(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    write!(
        out,
        "ply\nformat ascii 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    position_rows(mesh, "", out)?;
    face_rows(mesh, "3 ", out)
}

fn obj(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    position_rows(mesh, "v ", out)?;
    for [x, y, z] in &mesh.normals {
        writeln!(out, "vn {x:.4} {y:.4} {z:.4}")?;
    }
    for corners in &mesh.triangles {
        let [a, b, c] = corners.map(|corner| corner + 1);
        writeln!(out, "f {a}//{a} {b}//{b} {c}//{c}")?;
    }
    Ok(())
}

fn stl(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    out.write_all(&[b' '; 80])?;
    out.write_all(&(mesh.triangles.len() as u32).to_le_bytes())?;
    for corners in mesh.corners() {
        out.write_all(cast_slice(&[0.0_f32; 3]))?;
        out.write_all(cast_slice(&corners))?;
        out.write_all(&[0, 0])?;
    }
    Ok(())
}

fn stl_text(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "solid brain")?;
    for corners in mesh.corners() {
        writeln!(out, "facet normal 0 0 0\n outer loop")?;
        for [x, y, z] in corners {
            writeln!(out, "  vertex {x:.6} {y:.6} {z:.6}")?;
        }
        writeln!(out, " endloop\nendfacet")?;
    }
    writeln!(out, "endsolid brain")
}

fn off(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(
        out,
        "OFF\n{} {} 0",
        mesh.positions.len(),
        mesh.triangles.len()
    )?;
    position_rows(mesh, "", out)?;
    face_rows(mesh, "3 ", out)
}

fn glb(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    let parts: [&[u8]; 3] = [
        cast_slice(&mesh.positions),
        cast_slice(&mesh.normals),
        cast_slice(&mesh.triangles),
    ];
    let [positions, normals, _] = parts.map(<[u8]>::len);
    let total: usize = parts.iter().map(|part| part.len()).sum();
    let (mut low, mut high) = ([f32::MAX; 3], [f32::MIN; 3]);
    for position in &mesh.positions {
        for axis in 0..3 {
            low[axis] = low[axis].min(position[axis]);
            high[axis] = high[axis].max(position[axis]);
        }
    }
    let vertices = mesh.positions.len();
    let mut head = serde_json::to_vec(&json!({
        "asset": { "version": "2.0" },
        "buffers": [{ "byteLength": total }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": positions },
            { "buffer": 0, "byteOffset": positions, "byteLength": normals },
            { "buffer": 0, "byteOffset": positions + normals, "byteLength": total - positions - normals },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": vertices, "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": 5126, "count": vertices, "type": "VEC3" },
            { "bufferView": 2, "componentType": 5125, "count": mesh.triangles.len() * 3, "type": "SCALAR" },
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "NORMAL": 1 }, "indices": 2 }] }],
        "nodes": [{ "mesh": 0 }],
        "scenes": [{ "nodes": [0] }],
        "scene": 0,
    }))?;
    head.resize(head.len().next_multiple_of(4), b' ');
    let length = 12 + 8 + head.len() + 8 + total;
    out.write_all(b"glTF")?;
    for word in [2, length as u32, head.len() as u32] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(b"JSON")?;
    out.write_all(&head)?;
    out.write_all(&(total as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    parts.iter().try_for_each(|part| out.write_all(part))
}

fn pcd(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    let count = mesh.positions.len();
    write!(
        out,
        "VERSION 0.7\nFIELDS x y z rgb\nSIZE 4 4 4 4\nTYPE F F F U\nCOUNT 1 1 1 1\n\
         WIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n"
    )?;
    for (position, _, [r, g, b]) in mesh.rows() {
        out.write_all(cast_slice(&position))?;
        out.write_all(&[b, g, r, 0])?;
    }
    Ok(())
}

fn xyz(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    position_rows(mesh, "", out)
}

fn pts(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "{}", mesh.positions.len())?;
    for ([x, y, z], _, [r, g, b]) in mesh.rows() {
        writeln!(out, "{x:.6} {y:.6} {z:.6} 100 {r} {g} {b}")?;
    }
    Ok(())
}

/// Version 1.2, point format 2, in ten-thousandths.
fn las(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    const STEP: f64 = 1e-4;
    let mut head = b"LASF".to_vec();
    head.resize(24, 0);
    head.extend([1, 2]);
    head.resize(94, 0);
    head.extend(227_u16.to_le_bytes());
    head.extend(227_u32.to_le_bytes());
    head.extend(0_u32.to_le_bytes());
    head.push(2);
    head.extend(26_u16.to_le_bytes());
    head.extend((mesh.positions.len() as u32).to_le_bytes());
    head.resize(131, 0);
    for value in [STEP, STEP, STEP, 0.0, 0.0, 0.0] {
        head.extend(value.to_le_bytes());
    }
    head.resize(227, 0);
    out.write_all(&head)?;
    for (position, _, colour) in mesh.rows() {
        let position = position.map(|value| (f64::from(value) / STEP).round() as i32);
        out.write_all(cast_slice(&position))?;
        out.write_all(&[0, 0, 0b0000_1001, 2, 0, 0, 0, 0])?;
        out.write_all(cast_slice(&colour.map(|value| u16::from(value) * 257)))?;
    }
    Ok(())
}

fn tri(mesh: &Mesh, out: &mut dyn Write) -> std::io::Result<()> {
    writeln!(out, "Vertices {}", mesh.positions.len())?;
    position_rows(mesh, "", out)?;
    writeln!(out, "Triangles {}", mesh.triangles.len())?;
    face_rows(mesh, "", out)
}
