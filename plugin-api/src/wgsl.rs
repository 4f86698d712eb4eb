//! Linking of shaders: WESL modules, the SDK's own library among them, into one plain WGSL text.
//!
//! Only plain WGSL crosses the border, so a plugin links its shaders itself, with the library of the SDK that it was built
//! with. A shader imports what it needs and switches variants by features:
//!
//! ```
//! use pointstage_plugin_api::wgsl::{Module, link};
//!
//! let main = Module::new(
//!     "mine::depth_pass",
//!     "import lib::camera::clip_from_view;
//!      import lib::surfel::{load_position_radius, surfel_number};
//!      @vertex
//!      fn depth_pass_vertex(@builtin(vertex_index) index: u32) -> @builtin(position) vec4f {
//!          let number = surfel_number(index);
//!          return clip_from_view(load_position_radius(number).xyz);
//!      }
//!      @if(shaded) @fragment
//!      fn depth_pass_fragment() -> @location(0) vec4f { return vec4f(1.0); }",
//! );
//! let wgsl = link(main, &[], &["shaded"])?;
//! assert!(wgsl.contains("fn depth_pass_fragment"));
//! # Ok::<(), pointstage_plugin_api::wgsl::WgslError>(())
//! ```
//!
//! Names of the main module stay as they are; names of imported ones get their module's path in front
//! (`lib::camera::frame` becomes `lib_camera_frame`), so that they meet no name of the plugin. What nothing reaches is left
//! out. Modules are named in import statements only, not in the midst of an expression. Plain WGSL, without imports and `@if`, passes through unchanged.
//!
//! The library's files lie in this crate's `shaders/lib` (the project's `shaders/lib` is a link to it), so that the
//! packaged crate is complete.

use std::borrow::Cow;
use wesl::syntax::{ModulePath, PathOrigin, TranslationUnit};
use wesl::{
    CompileOptions, Diagnostic, Feature, Features, Mangler, ResolveError, Resolver, VirtualResolver,
};

/// One shader file: its text, and the path by which others import from it.
#[derive(Clone, Copy, Debug)]
pub struct Module<'a> {
    /// Such as `points::sprite`: the crate or folder, then the file's name without its ending.
    pub path: &'a str,
    /// WESL or plain WGSL.
    pub source: &'a str,
}

impl<'a> Module<'a> {
    /// A module from its path and its text, usually `include_str!`.
    pub const fn new(path: &'a str, source: &'a str) -> Self {
        Self { path, source }
    }
}

/// Declares the library: one `lib::<name>` for each file of `shaders/lib`.
macro_rules! library {
    ($($name:literal),* $(,)?) => {
        /// The modules of the SDK's shader library, `lib::…`.
        pub const LIBRARY: &[Module<'static>] = &[$(Module::new(
            concat!("lib::", $name),
            include_str!(concat!("../shaders/lib/", $name, ".wesl")),
        )),*];
    };
}
library![
    "camera",
    "clip",
    "colour",
    "depth",
    "ellipse",
    "lighting",
    "octahedral",
    "surfel"
];

/// Why shaders do not link.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum WgslError {
    /// A module's path is not of the form `folder::file`.
    #[error(
        "shader module '{path}': expected a path such as 'mine::depth_pass', names of letters, digits and '_' joined by '::'"
    )]
    BadPath {
        /// The path.
        path: String,
    },
    /// A module does not parse, or imports what does not exist.
    #[error("{file}, line {line}, column {column}: {message}")]
    At {
        /// Path of the module.
        file: String,
        /// Counted from 1.
        line: usize,
        /// Characters, counted from 1.
        column: usize,
        /// What is wrong.
        message: String,
    },
    /// An error that belongs to a module as a whole.
    #[error("{file}: {message}")]
    In {
        /// Path of the module.
        file: String,
        /// What is wrong.
        message: String,
    },
}

/// Links `main` with `modules` and the library to plain WGSL. Of the features that `@if` names, those in `features` are on,
/// all others off.
///
/// # Errors
/// [`WgslError`] with file, line and column, where the linker can tell. It checks syntax and imports; types are checked
/// when the device makes the shader.
pub fn link(
    main: Module<'_>,
    modules: &[Module<'_>],
    features: &[&str],
) -> Result<String, WgslError> {
    if !needs_linking(main.source) {
        return Ok(main.source.to_owned());
    }
    let mut resolver = ModuleResolver(VirtualResolver::new());
    for module in LIBRARY.iter().chain(modules).chain([&main]) {
        resolver
            .0
            .add_module(parse_path(module.path)?, Cow::Borrowed(module.source));
    }
    let options = CompileOptions {
        features: Features {
            default: Feature::Disable,
            flags: features
                .iter()
                .map(|&name| (name.to_owned(), Feature::Enable))
                .collect(),
        },
        ..CompileOptions::default()
    };
    let linked = wesl::compile(&parse_path(main.path)?, &resolver, &PathMangler, &options)
        .map_err(|error| explain(error, main, &resolver))?;
    Ok(linked.to_string())
}

/// Whether the text uses what WESL adds to WGSL.
fn needs_linking(source: &str) -> bool {
    source.lines().any(|line| {
        let code = line.split("//").next().unwrap_or_default();
        code.trim_start().starts_with("import ") || code.contains("@if") || code.contains("::")
    })
}

/// The linker's form of a module's path.
fn parse_path(path: &str) -> Result<ModulePath, WgslError> {
    let is_name = |part: &str| {
        part.starts_with(|first: char| first.is_ascii_alphabetic())
            && part
                .chars()
                .all(|letter| letter.is_ascii_alphanumeric() || letter == '_')
    };
    let bad = || WgslError::BadPath {
        path: path.to_owned(),
    };
    if !path.contains("::") || !path.split("::").all(is_name) {
        return Err(bad());
    }
    path.parse().map(flatten).map_err(|_| bad())
}

/// The package of the library's modules.
const LIBRARY_PACKAGE: &str = "lib";

/// Takes a package's name as a folder of one great package. To the linker, packages that import from one another are each
/// other's dependencies, and the same module would be a different one for each of them.
fn flatten(path: ModulePath) -> ModulePath {
    match path.origin {
        PathOrigin::Package(package) if package != LIBRARY_PACKAGE => ModulePath {
            origin: PathOrigin::Absolute,
            components: [package].into_iter().chain(path.components).collect(),
        },
        _ => path,
    }
}

/// Modules in memory, with flat paths in their import statements.
struct ModuleResolver<'a>(VirtualResolver<'a>);

impl Resolver for ModuleResolver<'_> {
    fn resolve_source<'b>(&'b self, path: &ModulePath) -> Result<Cow<'b, str>, ResolveError> {
        self.0.resolve_source(path)
    }

    fn resolve_module(&self, path: &ModulePath) -> Result<TranslationUnit, ResolveError> {
        let mut module = self.0.resolve_module(path)?;
        for import in &mut module.imports {
            import.path = import.path.take().map(flatten);
        }
        Ok(module)
    }
}

/// Gives imported declarations their module's path as a prefix.
struct PathMangler;

impl Mangler for PathMangler {
    fn mangle(&self, path: &ModulePath, item: &str) -> String {
        let mut name = match &path.origin {
            PathOrigin::Package(package) => format!("{package}_"),
            PathOrigin::Absolute | PathOrigin::Relative(_) => String::new(),
        };
        for component in &path.components {
            name.push_str(component);
            name.push('_');
        }
        name + item
    }
}

/// The linker's error with the place in the module that it is about.
fn explain(error: wesl::Error, main: Module<'_>, modules: &ModuleResolver<'_>) -> WgslError {
    let Diagnostic { error, detail } = Diagnostic::from(error);
    let plain = |text: String| text.replace("package::", "");
    let file = detail
        .module_path
        .as_ref()
        .map_or_else(|| main.path.to_owned(), |path| plain(path.to_string()));
    let message = match *error {
        wesl::Error::ParseError(parse) => parse.error.to_string(),
        other => other.to_string(),
    };
    let message = plain(message);
    let source = match &detail.module_path {
        Some(path) => modules.resolve_source(path).ok(),
        None => Some(Cow::Borrowed(main.source)),
    };
    match (&detail.span, source) {
        (Some(span), Some(source)) => {
            let before = source.get(..span.range().start).unwrap_or(&source);
            let line_start = before.rfind('\n').map_or(0, |end| end + 1);
            WgslError::At {
                file,
                line: before.matches('\n').count() + 1,
                column: before[line_start..].chars().count() + 1,
                message,
            }
        }
        _ => WgslError::In { file, message },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_wgsl_passes_through_with_its_comments() {
        let source = "// import of goods\n@compute @workgroup_size(1)\nfn main() {}\n";
        assert_eq!(
            link(Module::new("mine::plain", source), &[], &[]).as_deref(),
            Ok(source)
        );
    }

    #[test]
    fn a_syntax_error_names_its_file_line_and_column() {
        let broken = Module::new(
            "mine::broken",
            "fn fine() -> f32 { return 1.0; }\nfn broken( {}\n",
        );
        let main = Module::new(
            "mine::main",
            "import mine::broken::fine;\n@compute @workgroup_size(1) fn main() { _ = fine(); }",
        );
        let error = link(main, &[broken], &[]).unwrap_err();
        assert!(
            matches!(&error, WgslError::At { file, line: 2, column: 12, .. } if file == "mine::broken"),
            "{error}"
        );
    }

    #[test]
    fn an_import_that_does_not_exist_is_named() {
        let main = Module::new(
            "mine::main",
            "import lib::camera::no_such_thing;\n@compute @workgroup_size(1) fn main() { _ = no_such_thing(); }",
        );
        let text = link(main, &[], &[]).unwrap_err().to_string();
        assert!(
            text.contains("no_such_thing") && text.contains("lib::camera"),
            "{text}"
        );
        let main = Module::new(
            "mine::main",
            "import lib::camara::frame;\n@compute @workgroup_size(1) fn main() { _ = frame.near; }",
        );
        let text = link(main, &[], &[]).unwrap_err().to_string();
        assert!(text.contains("camara"), "{text}");
    }

    #[test]
    fn a_path_without_a_folder_is_refused() {
        for path in ["", "main", "a::", "a::b c", "::a"] {
            let error =
                link(Module::new(path, "import lib::camera::frame;"), &[], &[]).unwrap_err();
            assert_eq!(
                error,
                WgslError::BadPath {
                    path: path.to_owned()
                }
            );
        }
    }

    #[test]
    fn equal_names_in_two_modules_stay_apart() {
        let other = Module::new(
            "mine::other",
            "fn helper() -> f32 { return 1.0; } fn used() -> f32 { return helper(); }",
        );
        let main = Module::new(
            "mine::main",
            "import mine::other::used;\nfn helper() -> f32 { return 2.0; }\n\
             @compute @workgroup_size(1) fn main() { _ = used() + helper(); }",
        );
        let wgsl = link(main, &[other], &[]).unwrap();
        assert!(
            wgsl.contains("fn mine_other_helper") && wgsl.contains("fn helper"),
            "{wgsl}"
        );
    }
}
