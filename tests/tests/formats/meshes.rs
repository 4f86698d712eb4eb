//! Meshes: vertices, faces, normals, colours and texture coordinates are those of the file.

use anyhow::{Context as _, Result};
use glam::{DVec3, Vec3};
use pointstage_scene::{Job, LoadOptions, Loaded, Provenance, Warnings, load_with};
use pointstage_tests::loaders::{first_party, load_bytes};

use crate::small;

/// Vertices in the world.
fn positions(loaded: &Loaded) -> Vec<[f64; 3]> {
    let object = &loaded.object;
    let centres =
        (0..object.geometry.surfel_count).filter_map(|index| object.geometry.centre(index));
    centres
        .map(|centre| (object.origin + centre).to_array())
        .collect()
}

fn triangles(loaded: &Loaded) -> Vec<[u32; 3]> {
    loaded
        .object
        .geometry
        .triangles
        .as_ref()
        .map_or_else(Vec::new, |all| all.to_vec())
}

/// Red, green, blue of each vertex.
pub(crate) fn colours(loaded: &Loaded) -> Vec<[u8; 3]> {
    let blocks = loaded.object.geometry.blocks.iter();
    let packed = blocks.flat_map(|block| block.colour.iter().flat_map(|column| column.iter()));
    packed
        .map(|colour| {
            let [red, green, blue, _] = colour.to_le_bytes();
            [red, green, blue]
        })
        .collect()
}

fn normal(loaded: &Loaded, vertex: usize) -> Vec3 {
    loaded.object.geometry.blocks[0]
        .normal_at(vertex)
        .unwrap_or(Vec3::NAN)
}

pub(crate) fn lines(warnings: &Warnings) -> String {
    let lines: Vec<String> = warnings.iter().map(ToString::to_string).collect();
    lines.join("\n")
}

#[test]
fn obj_has_corners_normals_materials_and_texture_coordinates() -> Result<()> {
    let folder = tempfile::tempdir()?;
    std::fs::write(folder.path().join("small.mtl"), small::MTL)?;
    let loaded = load_bytes(
        &first_party()?,
        folder.path(),
        "a.obj",
        small::OBJ.as_bytes(),
    )?;
    assert_eq!(loaded.loader.id, "org.pointstage.obj");
    let at = positions(&loaded);
    assert_eq!(at[1], [600_001.25, 0.0, 0.0]);
    assert_eq!(at.len(), 5);
    assert_eq!(triangles(&loaded), [[0, 1, 2], [0, 2, 3], [0, 4, 1]]);
    // Vertex 2 has a normal of each of two faces, vertex 3 of one.
    let both = Vec3::new(1.0, 0.0, 1.0).normalize();
    assert!(
        normal(&loaded, 0).distance(both) < 1e-3,
        "{}",
        normal(&loaded, 0)
    );
    assert!(normal(&loaded, 2).distance(Vec3::Z) < 1e-3);
    // Of the square's two triangles and the blue one vertex 1 has all, vertex 2 one of each: as light, and back to sRGB.
    assert_eq!(
        colours(&loaded),
        [
            [213, 0, 156],
            [188, 0, 188],
            [255, 0, 0],
            [255, 0, 0],
            [0, 0, 255]
        ]
    );
    let uv = &loaded.object.geometry.blocks[0].named[0];
    assert_eq!((&*uv.name, uv.components), ("uv", 2));
    assert_eq!((uv.value(1, 0), uv.value(1, 1)), (Some(1.0), Some(0.5)));
    assert!(uv.value(3, 0).is_some_and(f64::is_nan), "vertex 4 has none");
    let said = lines(&loaded.warnings);
    assert!(
        said.contains("line or point element") && said.contains("texture"),
        "{said}"
    );
    Ok(())
}

#[test]
fn obj_has_vertex_colours_in_either_range_and_bad_corners_are_counted() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for scale in ["1 0 0.5", "255 0 127.5"] {
        let text = format!("v 0 0 0 {scale}\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 9\nf 0 1 2\n");
        let loaded = load_bytes(&loaders, folder.path(), "a.obj", text.as_bytes())?;
        assert_eq!(colours(&loaded)[0], [255, 0, 128], "{scale}");
        assert_eq!(triangles(&loaded).len(), 1);
        assert!(lines(&loaded.warnings).contains("2 faces with corners that do not exist"));
    }
    Ok(())
}

#[test]
fn obj_errors_name_the_line() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (text, part) in [
        (
            "v 0 0 0\nv 1 x 0\n",
            "line 2: expected 3 to 7 numbers behind 'v', found 'v 1 x 0'",
        ),
        ("v 0 0 0\nf 1 a 1\n", "line 2: expected corners"),
        ("v 0 0 0\nf 1 1\n", "three corners or more"),
        ("o nothing\n", "no vertices"),
    ] {
        let error = load_bytes(&loaders, folder.path(), "a.obj", text.as_bytes());
        let error = error
            .err()
            .with_context(|| format!("{text} was taken"))?
            .to_string();
        assert!(
            error.contains(part) && error.contains("a.obj"),
            "{text}: {error}"
        );
    }
    Ok(())
}

#[test]
fn stl_of_both_kinds_is_one_mesh_of_shared_vertices() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    for (name, content) in [
        ("a.stl", small::STL_TEXT.into()),
        ("b.stl", small::stl_binary()),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, content)?;
        let loaded = load_with(&loaders, &path, &LoadOptions::default(), &Job::new())?;
        assert_eq!(loaded.loader.alias, "stl");
        assert_eq!(
            positions(&loaded),
            [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]
        );
        assert_eq!(
            triangles(&loaded),
            [[0, 1, 2], [0, 2, 3], [0, 3, 1], [2, 1, 3]]
        );
        assert_eq!(
            loaded.object.geometry.origins.normals,
            Provenance::FromFaces
        );
        // The corner at the origin looks away from the middle.
        assert!(
            normal(&loaded, 0).dot(Vec3::ONE) < -1.7,
            "{}",
            normal(&loaded, 0)
        );
    }
    Ok(())
}

#[test]
fn off_has_colours_and_normals_and_its_polygons_are_cut() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaders = first_party()?;
    let loaded = load_bytes(&loaders, folder.path(), "a.off", small::OFF.as_bytes())?;
    assert_eq!(positions(&loaded)[4], [0.5, 0.5, 1.0]);
    assert_eq!(triangles(&loaded).len(), 6);
    assert_eq!(colours(&loaded)[4], [10, 20, 30]);
    assert!(normal(&loaded, 1).distance(Vec3::NEG_Z) < 1e-3);
    assert!(lines(&loaded.warnings).contains("a face has a colour"));
    for (text, part) in [
        ("4OFF\n1 0 0\n1 2 3 4", "not of three coordinates"),
        ("OFF BINARY\n", "binary OFF is not read"),
        ("OFF\n2 0 0\n1 2 3\n", "expected vertex 2 of 2"),
        ("OFF\n1 1 0\n1 2 3\n4 0 0 0\n", "4 corners"),
        ("OFF\n0 0 0\n", "0 vertices"),
        ("OFF\nx\n", "line 2: expected the numbers of vertices"),
    ] {
        let error = load_bytes(&loaders, folder.path(), "a.off", text.as_bytes());
        let error = error
            .err()
            .with_context(|| format!("{text} was taken"))?
            .to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
    Ok(())
}

#[test]
fn gltf_puts_meshes_where_their_nodes_do_and_multiplies_colours_as_light() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let loaded = load_bytes(&first_party()?, folder.path(), "a.glb", &small::glb())?;
    assert_eq!(loaded.loader.alias, "gltf");
    let at: Vec<DVec3> = positions(&loaded).into_iter().map(DVec3::from).collect();
    assert_eq!(at.len(), 6, "a triangle, and three points");
    let has = |x: f64, y: f64| at.contains(&DVec3::new(x, y, 0.0));
    assert!(
        has(10.0, 0.0) && has(8.0, 0.0) && has(10.0, 1.0) && has(1.0, 0.0),
        "{at:?}"
    );
    let triangles = triangles(&loaded);
    assert_eq!(triangles.len(), 1);
    // The node mirrors: the triangle is turned over, so that it still looks along z.
    let [a, b, c] = triangles[0].map(|corner| at[corner as usize]);
    assert!((b - a).cross(c - a).z > 0.0);
    let red = at
        .iter()
        .position(|place| place.x == 10.0 && place.y == 0.0);
    let green = at.iter().position(|place| place.x == 8.0);
    let (red, green) = (red.context("the red one")?, green.context("the green one")?);
    // Half the light is 188 of 255 in sRGB.
    assert_eq!(
        (colours(&loaded)[red], colours(&loaded)[green]),
        ([188, 0, 0], [0, 188, 0])
    );
    assert!(normal(&loaded, red).distance(Vec3::Z) < 1e-3);
    let plain = at
        .iter()
        .position(|place| place.x == 1.0)
        .context("a point")?;
    assert_eq!(colours(&loaded)[plain], [255; 3]);
    Ok(())
}

#[test]
fn gltf_with_a_texture_beside_it_takes_its_texels() -> Result<()> {
    let folder = tempfile::tempdir()?;
    let picture = image::RgbImage::from_fn(2, 1, |x, _| {
        image::Rgb(if x == 0 { [200, 10, 30] } else { [0, 90, 255] })
    });
    picture.save(folder.path().join("a b.png"))?;
    let mut buffer: Vec<u8> = Vec::new();
    let positions: [[f32; 3]; 3] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let uvs: [[f32; 2]; 3] = [[0.1, 0.2], [0.3, 0.2], [0.2, 0.8]];
    buffer.extend(bytemuck::cast_slice::<_, u8>(&positions));
    buffer.extend(bytemuck::cast_slice::<_, u8>(&uvs));
    std::fs::write(folder.path().join("data.bin"), &buffer)?;
    let document = serde_json::json!({
        "asset": {"version": "2.0"},
        "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": "a%20b.png"}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
            {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
        ],
        "buffers": [{"byteLength": 60, "uri": "data.bin"}],
    });
    let text = document.to_string();
    let loaded = load_bytes(&first_party()?, folder.path(), "a.gltf", text.as_bytes())?;
    assert_eq!(colours(&loaded), [[200, 10, 30]; 3]);
    std::fs::remove_file(folder.path().join("a b.png"))?;
    let plain = load_bytes(&first_party()?, folder.path(), "a.gltf", text.as_bytes())?;
    assert!(
        lines(&plain.warnings).contains("the texture 'a%20b.png' cannot be read"),
        "{}",
        lines(&plain.warnings)
    );
    Ok(())
}
