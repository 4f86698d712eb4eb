//! Textures and colours of faces: is a vertex's colour the mean of what its part of the surface covers?

use std::path::Path;

use anyhow::{Context as _, Result};
use image::{ImageFormat, Rgb, RgbImage, Rgba, RgbaImage};
use pointstage_plugin_api::settings_schema::SettingValue;
use pointstage_scene::{Estimation, Job, LoadOptions, Loaded, LoaderChoice, Loaders, load_with};
use pointstage_tests::loaders::{first_party, load_bytes};
use serde_json::{Value, json};

use crate::meshes::{colours, lines};

/// A square of two triangles on the left half of a picture, as OBJ.
pub(crate) const SQUARE: &str = "\
mtllib square.mtl
v 0 0 0 0 1 0
v 1 0 0 0 1 0
v 1 1 0 0 1 0
v 0 1 0 0 1 0
v 0 0 1 0 1 0
vt 0 0
vt 1 0
vt 1 1
vt 0 1
usemtl wood
f 1/1 2/2 3/3 4/4
";

pub(crate) const LIBRARY: &str = "newmtl wood\nKd 0 0 1\nmap_Kd maps\\my wood.png\n";

/// Left half red, right half white, as wide as it is high.
pub(crate) fn halves(side: u32) -> RgbImage {
    RgbImage::from_fn(side, side, |x, _| {
        Rgb(if 2 * x < side { [255, 0, 0] } else { [255; 3] })
    })
}

pub(crate) fn encoded(picture: &RgbImage, format: ImageFormat) -> Result<Vec<u8>> {
    let mut file = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut file, format)?;
    Ok(file.into_inner())
}

pub(crate) fn load(loaders: &Loaders, path: &Path, loader: &str, textures: &str) -> Result<Loaded> {
    let value = SettingValue::Choice(textures.to_owned());
    let options = LoadOptions {
        loader: Some(LoaderChoice {
            loader: loader.to_owned(),
            settings: [("textures".to_owned(), value)].into(),
        }),
        estimation: Estimation::FileOnly,
        ..LoadOptions::default()
    };
    Ok(load_with(loaders, path, &options, &Job::new())?)
}

fn triangle_count(loaded: &Loaded) -> usize {
    loaded.object.geometry.triangle_count()
}

#[test]
fn obj_vertices_take_the_mean_of_the_texels_round_them() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("square.obj");
    std::fs::write(&path, SQUARE)?;
    std::fs::write(folder.path().join("square.mtl"), LIBRARY)?;
    std::fs::create_dir(folder.path().join("maps"))?;
    halves(64).save(folder.path().join("maps/my wood.png"))?;
    let loaders = first_party()?;

    let loaded = load(&loaders, &path, "obj", "vertices")?;
    assert!(loaded.warnings.is_empty(), "{}", lines(&loaded.warnings));
    assert_eq!(triangle_count(&loaded), 2);
    let found = colours(&loaded);
    // On the left side only red is near. The corners at the right belong to one or both triangles, whose parts of the
    // picture are white, but for a little of the red beyond the middle.
    assert_eq!(found[3], [255, 0, 0]);
    assert!(found[0][1] < 110 && found[1][1] > 250, "{found:?}");
    // No face has this one: it keeps its own colour.
    assert_eq!(found[4], [0, 255, 0]);

    let divided = load(&loaders, &path, "obj", "divide")?;
    let geometry = &divided.object.geometry;
    // An edge covers at most 3 of 64 texels: at least 22 parts a side.
    assert!(geometry.surfel_count > 23 * 23, "{}", geometry.surfel_count);
    let colours = colours(&divided);
    for (surfel, colour) in colours.iter().enumerate() {
        let at = geometry.centre(surfel).context("a centre")?;
        if (at.x - 0.5).abs() > 3.0 / 64.0 && at.z == 0.0 {
            let expected = if at.x < 0.5 { [255, 0, 0] } else { [255; 3] };
            assert_eq!(*colour, expected, "at {at}");
        }
    }
    let uv = &geometry.blocks[0].named[0];
    for surfel in 0..geometry.surfel_count.min(500) {
        let at = geometry.centre(surfel).context("a centre")?;
        let values = [uv.value(surfel, 0), uv.value(surfel, 1)].map(Option::unwrap_or_default);
        let is_on_it = (values[0] - at.x).abs() < 1e-5 && (values[1] - at.y).abs() < 1e-5;
        assert!(is_on_it || surfel == 4, "{at} has {values:?}");
    }

    let without = load(&loaders, &path, "obj", "none")?;
    assert_eq!(
        crate::meshes::colours(&without)[0],
        [0, 255, 0],
        "its own colour"
    );
    Ok(())
}

#[test]
fn a_missing_texture_is_a_warning_that_names_it_and_leaves_the_plain_colour() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let path = folder.path().join("square.obj");
    // Without colours of vertices the material's plain colour is next.
    std::fs::write(&path, SQUARE.replace(" 0 1 0\n", "\n"))?;
    std::fs::write(folder.path().join("square.mtl"), LIBRARY)?;
    let loaders = first_party()?;
    let loaded = load(&loaders, &path, "obj", "divide")?;
    assert_eq!(colours(&loaded)[..4], [[0, 0, 255]; 4]);
    let said = lines(&loaded.warnings);
    assert!(
        said.contains("'maps\\my wood.png'") && said.contains("cannot be read"),
        "{said}"
    );
    // Beside the file, and not a picture.
    std::fs::write(folder.path().join("my wood.png"), b"GIF89a, in truth")?;
    let loaded = load(&loaders, &path, "obj", "divide")?;
    let said = lines(&loaded.warnings);
    assert!(said.contains("neither PNG nor JPEG"), "{said}");
    Ok(())
}

/// A square of two triangles with a texture as one binary file, and a point that takes a texel.
pub(crate) fn glb(picture: &[u8], material: &Value) -> Vec<u8> {
    let positions: [[f32; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
    let uvs: [[f32; 2]; 4] = [[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]];
    let colours: [[u8; 4]; 4] = [[255, 255, 255, 255]; 4];
    let indices: [u16; 6] = [0, 1, 2, 0, 2, 3];
    let mut binary: Vec<u8> = Vec::new();
    let mut views = Vec::new();
    let parts: [&[u8]; 5] = [
        bytemuck::cast_slice(&positions),
        bytemuck::cast_slice(&uvs),
        bytemuck::cast_slice(&colours),
        bytemuck::cast_slice(&indices),
        picture,
    ];
    for bytes in parts {
        views.push(json!({"buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len()}));
        binary.extend(bytes);
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    let attributes = json!({"POSITION": 0, "TEXCOORD_0": 1, "COLOR_0": 2});
    let document = json!({
        "asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [
            {"attributes": attributes, "indices": 3, "material": 0},
            {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "mode": 0, "material": 0},
        ]}],
        "materials": [material],
        "textures": [{"source": 0}], "images": [{"bufferView": 4, "mimeType": "image/png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5121, "count": 4, "type": "VEC4", "normalized": true},
            {"bufferView": 3, "componentType": 5123, "count": 6, "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": binary.len()}],
    });
    let mut text = document.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = b"glTF".to_vec();
    file.extend(2_u32.to_le_bytes());
    file.extend((28 + text.len() as u32 + binary.len() as u32).to_le_bytes());
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(b"JSON");
    file.extend(text);
    file.extend((binary.len() as u32).to_le_bytes());
    file.extend(b"BIN\0");
    file.extend(binary);
    file
}

#[test]
fn glb_has_its_texture_inside_times_factor_and_alpha_counts_where_it_should() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    // The upper half is opaque white, the lower half black that cannot be seen.
    let picture = RgbaImage::from_fn(8, 8, |_, y| Rgba(if y < 4 { [255; 4] } else { [0; 4] }));
    let mut file = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut file, ImageFormat::Png)?;
    let picture = file.into_inner();
    let pbr = json!({"baseColorTexture": {"index": 0}, "baseColorFactor": [0.5, 1.0, 1.0, 1.0]});
    let path = folder.path().join("a.glb");
    let of = |mode: &str| -> Result<Loaded> {
        let material = json!({"pbrMetallicRoughness": pbr, "alphaMode": mode});
        std::fs::write(&path, glb(&picture, &material))?;
        load(&loaders, &path, "gltf", "vertices")
    };
    let masked = of("MASK")?;
    assert_eq!(masked.object.geometry.surfel_count, 8);
    let found = colours(&masked);
    // Half of the red light is 188. Whatever is black has no say where there is anything else.
    assert_eq!((found[2], found[3]), ([188, 255, 255], [188, 255, 255]));
    assert_eq!(found[6], [188, 255, 255], "a point takes its texel");
    let opaque = of("OPAQUE")?;
    let found = colours(&opaque);
    assert!(
        found[0][1] < 130 && found[2][1] < 255 && found[2][0] < found[2][1],
        "{found:?}"
    );
    Ok(())
}

#[test]
fn ply_takes_pictures_of_corners_and_of_vertices() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let white = encoded(&RgbImage::from_pixel(8, 8, Rgb([255; 3])), ImageFormat::Png)?;
    std::fs::write(
        folder.path().join("b wood.jpg"),
        encoded(&halves(64), ImageFormat::Jpeg)?,
    )?;
    let corners = "\
ply
format ascii 1.0
comment TextureFile <this>_A.png
comment TextureFile b wood.jpg
element vertex 6
property float x
property float y
property float z
property int id
element face 3
property list uchar int vertex_indices
property list uchar float texcoord
property int texnumber
end_header
0 0 0 10
1 0 0 11
1 1 0 12
0 1 0 13
5 0 0 14
5 1 0 15
4 0 1 2 3 8 0 0 1 0 1 1 0 1 1
3 1 4 2 6 0 0 1 0 0 1 0
3 4 5 2 6 0 0 1 0 1 1 -1
";
    let path = folder.path().join("corners.ply");
    std::fs::write(&path, corners)?;
    std::fs::write(folder.path().join("corners_A.png"), white)?;
    let loaded = load(&loaders, &path, "ply", "vertices")?;
    assert!(loaded.warnings.is_empty(), "{}", lines(&loaded.warnings));
    let found = colours(&loaded);
    // JPEG is not exact.
    assert!(
        found[3][0] > 250 && found[3][1] < 8,
        "the left side is red: {found:?}"
    );
    // White of the first picture, and of the second's right half.
    assert!(found[2].iter().all(|channel| *channel > 240), "{found:?}");
    assert_eq!(found[4], [255; 3]);
    let named = &loaded.object.geometry.blocks[0].named;
    let names: Vec<&str> = named.iter().map(|column| &*column.name).collect();
    assert_eq!(names, ["id", "texture_u", "texture_v"]);
    assert_eq!(
        (named[1].value(2, 0), named[2].value(2, 0)),
        (Some(1.0), Some(1.0))
    );

    let divided = load(&loaders, &path, "ply", "divide")?;
    let geometry = &divided.object.geometry;
    assert!(geometry.surfel_count > 23 * 23, "{}", geometry.surfel_count);
    assert_eq!(
        geometry.blocks[0].named[0].value(6, 0),
        Some(10.0),
        "of the first end"
    );
    for (surfel, colour) in colours(&divided).iter().enumerate() {
        let at = geometry.centre(surfel).context("a centre")?;
        if at.x < 0.45 {
            assert!(colour[0] > 245 && colour[1] < 25, "{colour:?} at {at}");
        }
    }

    let none = load(&loaders, &path, "ply", "none")?;
    assert!(none.object.geometry.blocks[0].colour.is_none());
    assert_eq!(none.object.geometry.blocks[0].named.len(), 3);

    let rows = "\
ply
format ascii 1.0
comment TextureFile b wood.jpg
element vertex 3
property float x
property float y
property float z
property float s
property float t
element face 1
property list uchar int vertex_indices
end_header
0 0 0 0.1 0.1
1 0 0 0.2 0.1
0 1 0 0.1 0.2
3 0 1 2
";
    let loaded = load_bytes(&loaders, folder.path(), "rows.ply", rows.as_bytes())?;
    for colour in colours(&loaded) {
        assert!(colour[0] > 250 && colour[1] < 8, "{colour:?}");
    }
    Ok(())
}

#[test]
fn vertices_take_the_mean_of_their_faces_colours_as_light() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    // Two triangles of one area: black and white give half the light.
    let ply = "\
ply
format ascii 1.0
element vertex 5
property float x
property float y
property float z
element face 2
property list uchar int vertex_indices
property uchar red
property uchar green
property uchar blue
end_header
0 0 0
1 0 0
1 1 0
0 1 0
9 9 9
3 0 1 2 255 255 255
3 0 2 3 0 0 0
";
    let off = "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n9 9 9\n3 0 1 2 255 255 255\n3 0 2 3 0 0 0\n";
    let off_floats = "OFF\n5 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n9 9 9\n3 0 1 2 1.0 1.0 1.0 1.0\n3 0 2 3 0. 0. 0. 1.\n";
    let mut stl = vec![b' '; 80];
    stl.extend(2_u32.to_le_bytes());
    for (corners, word) in [
        ([[0, 0], [1, 0], [1, 1]], 0xffff_u16),
        ([[0, 0], [1, 1], [0, 1]], 0x8000),
    ] {
        stl.extend([0; 12]);
        for [x, y] in corners {
            for value in [x, y, 0] {
                stl.extend((value as f32).to_le_bytes());
            }
        }
        stl.extend(word.to_le_bytes());
    }
    for (name, content) in [
        ("a.ply", ply.as_bytes()),
        ("a.off", off.as_bytes()),
        ("b.off", off_floats.as_bytes()),
        ("a.stl", &stl),
    ] {
        let loaded = load_bytes(&loaders, folder.path(), name, content)?;
        let found = colours(&loaded);
        assert_eq!(
            found[..4],
            [[188; 3], [255; 3], [188; 3], [0; 3]],
            "{name}, {}",
            lines(&loaded.warnings)
        );
        if name != "a.stl" {
            assert_eq!(found[4], [255; 3], "{name}: what no face has is white");
        }
    }
    Ok(())
}
