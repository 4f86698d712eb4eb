//! The shader library: every module validates, and what it shares with Rust has the same layout and the same values.

use core::mem::{offset_of, size_of};
use naga::valid::{Capabilities, ValidationFlags, Validator};
use pointstage_plugin_api::abi::{
    DrawFlags, DrawUniform, FrameUniform, LightUniform, standard_bindings,
};
use pointstage_plugin_api::clip::ClipLines;
use pointstage_plugin_api::wgsl::{LIBRARY, Module, link};

fn validated(what: &str, wgsl: &str) -> naga::Module {
    let module = naga::front::wgsl::parse_str(wgsl)
        .unwrap_or_else(|error| panic!("{what}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{what}: {}\n{wgsl}", error.emit_to_string(wgsl)));
    module
}

/// Links a compute shader that imports `items` of the library and runs `body`.
fn linked(items: &str, body: &str) -> naga::Module {
    let source = format!(
        "{items}\n@group(2) @binding(0) var<storage, read_write> sink: array<vec4f>;\n\
         @compute @workgroup_size(1) fn main(@builtin(global_invocation_id) id: vec3u) {{ {body} }}"
    );
    let wgsl = link(Module::new("test::main", &source), &[], &[])
        .unwrap_or_else(|error| panic!("{error}\n{source}"));
    validated(body, &wgsl)
}

#[test]
fn every_function_of_every_module_validates() {
    // Each function is kept by being named as an entry point's callee would be: through a module that re-declares
    // nothing and imports all of its names.
    for module in LIBRARY {
        let names: Vec<&str> = module
            .source
            .lines()
            .filter_map(|line| line.strip_prefix("fn ")?.split('(').next())
            .collect();
        assert!(!names.is_empty(), "{} has no functions", module.path);
        for name in names {
            let signature = module
                .source
                .split(&format!("\nfn {name}("))
                .nth(1)
                .unwrap();
            let arguments = signature.split(')').next().unwrap();
            let zero = |argument: &str| {
                let of_type = argument.split(':').nth(1).unwrap().trim();
                let is_struct = of_type.starts_with(char::is_uppercase);
                let import = is_struct.then(|| {
                    let home = match of_type {
                        "Surfel" => "surfel",
                        "ClipLines" => "clip",
                        _ => "ellipse",
                    };
                    format!("import lib::{home}::{of_type};\n")
                });
                (format!("{of_type}()"), import.unwrap_or_default())
            };
            let (values, imports): (Vec<_>, Vec<_>) = arguments
                .split(',')
                .filter(|text| text.contains(':'))
                .map(zero)
                .unzip();
            let mut imports: Vec<String> = imports;
            imports.sort();
            imports.dedup();
            let imports = format!("import {}::{name};\n{}", module.path, imports.concat());
            linked(
                &imports,
                &format!(
                    "let result = {name}({}); sink[id.x] = vec4f();",
                    values.join(", ")
                ),
            );
        }
    }
}

/// Members' names and offsets of a struct, and its size.
fn layout(module: &naga::Module, name: &str) -> (Vec<(String, u32)>, u32) {
    let suffix = format!("_{name}");
    let (_, found) = module
        .types
        .iter()
        .find(|(_, other)| {
            other
                .name
                .as_deref()
                .is_some_and(|other| other == name || other.ends_with(&suffix))
        })
        .unwrap_or_else(|| panic!("the shader has no struct {name}"));
    let naga::TypeInner::Struct { members, span } = &found.inner else {
        panic!("{name} is not a struct");
    };
    let members = members
        .iter()
        .map(|member| (member.name.clone().unwrap(), member.offset))
        .collect();
    (members, *span)
}

/// Compares a record with the shader's struct of the same name.
macro_rules! compare {
    ($module:expr, $type:ident { $($field:ident),* $(,)? }) => {{
        // Exhaustive: a field that is not listed does not compile.
        #[allow(dead_code, reason = "the pattern is the check")]
        fn all_fields_are_listed(value: $type) {
            let $type { $($field: _),* } = value;
        }
        let rust: Vec<(String, u32)> =
            vec![$((stringify!($field).to_owned(), offset_of!($type, $field) as u32)),*];
        let (shader, span) = layout($module, stringify!($type));
        assert_eq!(shader, rust, "members and offsets of {}", stringify!($type));
        assert_eq!(span as usize, size_of::<$type>(), "size of {}", stringify!($type));
    }};
}

#[test]
fn uniforms_have_the_layout_of_their_records() {
    let module = linked(
        "import lib::camera::{draw, frame};",
        "sink[0] = frame.lights[0].colour + draw.default_colour;",
    );
    compare!(
        &module,
        LightUniform {
            position_view,
            colour
        }
    );
    compare!(
        &module,
        FrameUniform {
            clip_from_view,
            view_from_clip,
            view_from_world,
            image_size_px,
            tile_origin_px,
            tile_size_px,
            pixels_per_unit,
            near,
            far,
            is_orthographic,
            radius_scale,
            light_count,
            frame_index,
            sample_index,
            seed,
            interaction,
            ambient,
            lights,
        }
    );
    compare!(
        &module,
        DrawUniform {
            view_from_object,
            object_from_view,
            view_from_object_normal,
            material,
            radius_factor,
            first,
            count,
            id_base,
            flags,
            indirect_index,
            level,
            error,
            default_colour,
        }
    );
}

#[test]
fn clip_lines_have_the_layout_of_their_records() {
    let module = linked(
        "import lib::clip::ClipLines;\n@group(2) @binding(1) var<storage, read> lines: array<ClipLines>;",
        "sink[0] = vec4f(lines[0].second, lines[0].is_union);",
    );
    compare!(
        &module,
        ClipLines {
            first,
            is_union,
            second,
            padding
        }
    );
}

#[test]
fn bindings_have_the_standard_numbers() {
    let module = linked(
        "import lib::surfel::{load_surfel, load_axes_view, surfel_count};\nimport lib::camera::frame;",
        "let surfel = load_surfel(surfel_count() - 1u);
         let axes = load_axes_view(surfel.number, surfel.radius, surfel.centre);
         sink[0] = vec4f(axes.u, frame.near) + surfel.colour;",
    );
    let expected = [
        ("lib_camera_frame", 0, standard_bindings::FRAME),
        ("lib_camera_draw", 0, standard_bindings::DRAW),
        (
            "lib_surfel_position_radius_column",
            1,
            standard_bindings::POSITION_RADIUS,
        ),
        ("lib_surfel_normal_column", 1, standard_bindings::NORMAL),
        ("lib_surfel_colour_column", 1, standard_bindings::COLOUR),
        ("lib_surfel_axes_column", 1, standard_bindings::AXES),
        ("lib_surfel_index_column", 1, standard_bindings::INDICES),
        ("lib_surfel_indirect_counts", 1, standard_bindings::INDIRECT),
    ];
    for (name, group, binding) in expected {
        let (_, variable) = module
            .global_variables
            .iter()
            .find(|(_, variable)| variable.name.as_deref() == Some(name))
            .unwrap_or_else(|| panic!("the shader has no variable {name}"));
        assert_eq!(
            variable.binding,
            Some(naga::ResourceBinding { group, binding }),
            "{name}"
        );
    }
}

#[test]
fn flags_have_the_values_of_the_border() {
    let source = LIBRARY
        .iter()
        .find(|module| module.path == "lib::camera")
        .unwrap()
        .source;
    let mut count = 0;
    for line in source
        .lines()
        .filter_map(|line| line.strip_prefix("const "))
    {
        let (name, value) = line.split_once(": u32 = ").unwrap();
        let value: u32 = value.trim_end_matches("u;").parse().unwrap();
        assert_eq!(DrawFlags(value).name(), Some(name));
        count += 1;
    }
    assert_eq!(count, 8, "flags in lib::camera");
    let octahedral = LIBRARY
        .iter()
        .find(|module| module.path == "lib::octahedral")
        .unwrap()
        .source;
    assert!(octahedral.contains(&format!(
        "const NO_NORMAL: u32 = {:#x}u;",
        pointstage_plugin_api::columns::NO_NORMAL
    )));
}
