//! Small files of every format, made up, with what is in them.

use bytemuck::cast_slice;
use serde_json::json;

/// A square of four vertices as OBJ, in all ways to name corners.
pub(crate) const OBJ: &str = "\
# a square and a triangle
mtllib small.mtl
o thing
v 600000.25 0 0
v 600001.25 0 0
v 600001.25 1 0
v 600000.25 1 0
v 600000.25 0 1
vt 0 0
vt 1 0.5
vn 0 0 1
vn 1 0 0
usemtl red paint
f 1/1/1 2/2/1 3//1 \\
  4//1
usemtl blue
f -5//2 -1//2 -4/2
l 1 2
";

/// Its materials.
pub(crate) const MTL: &str = "newmtl red paint\nKd 1 0 0\nnewmtl blue\nmap_Kd x.png\nKd 0 0 1\n";

/// A tetrahedron as text, with the normals that STL has.
pub(crate) const STL_TEXT: &str = "\
solid thing
 facet normal 0 0 -1
  outer loop
   vertex 0 0 0
   vertex 0 1 0
   vertex 1 0 0
  endloop
 endfacet
 facet normal 0 -1 0
  outer loop
   vertex 0 0 0
   vertex 1 0 0
   vertex 0 0 1
  endloop
 endfacet
 facet normal -1 0 0
  outer loop
   vertex -0 0 0
   vertex 0 0 1
   vertex 0 1 0
  endloop
 endfacet
 facet normal 1 1 1
  outer loop
   vertex 1 0 0
   vertex 0 1 0
   vertex 0 0 1
  endloop
 endfacet
endsolid thing
";

/// The same tetrahedron in binary; its header begins with 'solid' as some programs have it.
pub(crate) fn stl_binary() -> Vec<u8> {
    let mut file = b"solid but binary".to_vec();
    file.resize(80, b' ');
    file.extend(4_u32.to_le_bytes());
    let corners = [
        [0.0_f32, 0.0, 0.0],
        [0.0, 1.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 0.0, 1.0],
    ];
    for facet in [[0, 1, 2], [0, 2, 3], [0, 3, 1], [2, 1, 3]] {
        file.extend([0; 12]);
        for corner in facet {
            for value in corners[corner] as [f32; 3] {
                file.extend(value.to_le_bytes());
            }
        }
        file.extend([0, 0]);
    }
    file
}

/// A pyramid with colours, normals and comments.
pub(crate) const OFF: &str = "\
CNOFF 5 5 0 # counts on the first line
# normals come before colours
0 0 0  0 0 -1  255 0 0 255
1 0 0  0 0 -1  0 255 0 255

1 1 0  0 0 -1  0 0 255 255
0 1 0  0 0 -1  255 255 255 255
0.5 0.5 1  0 0 1  10 20 30 255
4 3 2 1 0
3 0 1 4 255 0 0
3 1 2 4
3 2 3 4
3 3 0 4
";

/// A triangle with linear vertex colours in a node that moves, turns and mirrors, and two points, as one binary file.
pub(crate) fn glb() -> Vec<u8> {
    let positions: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let normals: [[f32; 3]; 3] = [[0.0, 0.0, 1.0]; 3];
    let colours: [[f32; 4]; 3] = [
        [1.0, 0.0, 0.0, 1.0],
        [0.0, 0.5, 0.0, 1.0],
        [0.0, 0.0, 1.0, 1.0],
    ];
    let mut binary: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let parts: [&[u8]; 4] = [
        cast_slice(&positions),
        cast_slice(&normals),
        cast_slice(&colours),
        cast_slice(&[0_u16, 1, 2, 0]),
    ];
    for bytes in parts {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
    }
    let document = json!({
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0, 2]}],
        "nodes": [
            {"children": [1], "translation": [10.0, 0.0, 0.0]},
            {"mesh": 0, "scale": [-2.0, 1.0, 1.0]},
            {"mesh": 1},
        ],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 1.0, 1.0, 1.0]}}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}, "indices": 3, "material": 0}]},
            {"primitives": [{"attributes": {"POSITION": 0}, "mode": 0}]},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5126, "count": 3, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5123, "count": 3, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &binary)] {
        file.extend((chunk.len() as u32).to_le_bytes());
        file.extend(kind);
        file.extend(chunk);
    }
    file
}

/// The header of a PCD file with three points of position, packed colour, a byte and two distances.
fn pcd_header(body: &str) -> String {
    format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb label _ d\n\
         SIZE 4 4 4 4 1 1 8\nTYPE F F F F U U F\nCOUNT 1 1 1 1 1 3 2\nWIDTH 3\nHEIGHT 1\n\
         VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA {body}\n"
    )
}

/// Packed red, green and blue as the bits of a float.
fn packed(red: u8, green: u8, blue: u8) -> [u8; 4] {
    // With alpha 255 the bits are those of a NaN.
    [blue, green, red, 255]
}

fn pcd_fields(point: u8) -> [Vec<u8>; 7] {
    let at = f32::from(point);
    [
        at.to_le_bytes().to_vec(),
        (at + 0.25).to_le_bytes().to_vec(),
        (-at).to_le_bytes().to_vec(),
        packed(200 + point, point, 7).to_vec(),
        vec![point + 100],
        vec![9; 3],
        [f64::from(at) + 0.5, f64::from(at) + 0.75]
            .iter()
            .flat_map(|value| value.to_le_bytes())
            .collect(),
    ]
}

/// The file with its points one after the other.
pub(crate) fn pcd_binary() -> Vec<u8> {
    let points = (0..3).flat_map(pcd_fields).flatten();
    pcd_header("binary")
        .into_bytes()
        .into_iter()
        .chain(points)
        .collect()
}

/// The file with its fields one after the other, packed as literals: any LZF unpacker has to take that.
pub(crate) fn pcd_compressed() -> Vec<u8> {
    let points: Vec<[Vec<u8>; 7]> = (0..3).map(pcd_fields).collect();
    let unpacked: Vec<u8> = (0..7)
        .flat_map(|field| points.iter().flat_map(move |point| point[field].clone()))
        .collect();
    let mut data = Vec::new();
    for chunk in unpacked.chunks(32) {
        data.push(chunk.len() as u8 - 1);
        data.extend(chunk);
    }
    let mut file = pcd_header("binary_compressed").into_bytes();
    file.extend((data.len() as u32).to_le_bytes());
    file.extend((unpacked.len() as u32).to_le_bytes());
    file.extend(data);
    file
}

/// The file as text; its colours are whole numbers.
pub(crate) fn pcd_text() -> String {
    let header = pcd_header("ascii").replace("TYPE F F F F", "TYPE F F F U");
    let lines = (0..3_u8).map(|point| {
        let at = f64::from(point);
        let colour = u32::from_le_bytes(packed(200 + point, point, 7));
        format!(
            "{at} {} {} {colour} {} 9 9 9 {} {}\n",
            at + 0.25,
            -at,
            point + 100,
            at + 0.5,
            at + 0.75
        )
    });
    header + &lines.collect::<String>()
}

/// A LAS 1.2 file of point format 3 with these positions in hundredths, and a colour each.
pub(crate) fn las(points: &[([i32; 3], [u16; 3])]) -> Vec<u8> {
    let mut file = b"LASF".to_vec();
    file.resize(24, 0);
    file.extend([1, 2]);
    file.resize(94, 0);
    file.extend(227_u16.to_le_bytes());
    file.extend(227_u32.to_le_bytes());
    file.extend(0_u32.to_le_bytes());
    file.push(3);
    file.extend(34_u16.to_le_bytes());
    file.extend((points.len() as u32).to_le_bytes());
    file.resize(131, 0);
    // Scales, offsets, then the box, of which nothing is asked here.
    for value in [0.01, 0.01, 0.01, 500_000.0, 4_000_000.0, 0.0] {
        file.extend(f64::to_le_bytes(value));
    }
    file.resize(227, 0);
    for (index, (position, colour)) in points.iter().enumerate() {
        for value in position {
            file.extend(value.to_le_bytes());
        }
        file.extend((1000 + index as u16).to_le_bytes());
        file.extend([0b0000_1001, 2, 0, 0, 0, 0]);
        file.extend((index as f64 + 0.125).to_le_bytes());
        for value in colour {
            file.extend(value.to_le_bytes());
        }
    }
    file
}

/// Points with a heading, separated by commas.
pub(crate) const CSV: &str =
    "x,y,z,red,green,blue,time\n1.5,2,3,255,0,0,0.25\n4,5,6.5,0,128,255,0.5\n";

/// Points of two scans with their counts.
pub(crate) const PTS: &str =
    "2\n4500000.125 1 2 -900 10 20 30\n4500001.125 2 3 -800 40 50 60\n1\n4500002 3 4 5 70 80 90\n";

/// Every small file under a name of its own.
pub(crate) fn all() -> Vec<(&'static str, Vec<u8>)> {
    let points: Vec<([i32; 3], [u16; 3])> = (0..40)
        .map(|index| {
            (
                [index * 7, index * 11, index],
                [index as u16 * 1000, 0, 65535],
            )
        })
        .collect();
    vec![
        ("a.obj", OBJ.into()),
        ("a.stl", STL_TEXT.into()),
        ("b.stl", stl_binary()),
        ("a.off", OFF.into()),
        ("a.glb", glb()),
        ("a.pcd", pcd_text().into_bytes()),
        ("b.pcd", pcd_binary()),
        ("c.pcd", pcd_compressed()),
        ("a.las", las(&points)),
        ("a.csv", CSV.into()),
        ("a.pts", PTS.into()),
    ]
}
