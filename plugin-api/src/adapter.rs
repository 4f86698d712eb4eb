//! From the author's traits to the border's objects. Every entry point, `Drop` included, runs under the guard.

use crate::abi::{
    self, FactoryBox, FactoryObject, FactoryObject_TO, FrameRecord, HostRef, LoaderBox,
    LoaderObject_TO, LogLevel, OutcomeRecord, PrepareRecord, RendererBox, RendererObject,
    RendererObject_TO, SelectRecord, SelectionRecord, SelectorBox, SelectorObject,
    SelectorObject_TO, StructureBlockRecord, StructureBox, StructureObject, StructureObject_TO,
    ViewBox, ViewObject, ViewObject_TO,
};
use crate::error::Result;
use crate::frame::Frame;
use crate::guard::{border, drop_guarded};
use crate::host::{Host, Progress, no_extension};
use crate::loading::{Loader, LoaderAdapter};
use crate::renderer::{Renderer, View};
use crate::scene::{Changes, Scene};
use crate::settings::Settings;
use crate::structure::{Query, Selector, Structure, own_columns};
use abi_stable::sabi_trait::TD_Opaque;
use abi_stable::std_types::{ROption, RResult, RStr, RString, RVec};
use std::marker::PhantomData;
use std::sync::Arc;

/// A value whose `Drop` runs under the guard and tells the host if it panics.
struct Guarded<T> {
    value: Option<T>,
    host: Host,
    what: &'static str,
}

impl<T> Guarded<T> {
    fn new(value: T, host: Host, what: &'static str) -> Self {
        Self {
            value: Some(value),
            host,
            what,
        }
    }

    fn get(&self) -> &T {
        self.value.as_ref().expect("only Drop takes the value")
    }

    fn get_mut(&mut self) -> &mut T {
        self.value.as_mut().expect("only Drop takes the value")
    }
}

impl<T> Drop for Guarded<T> {
    fn drop(&mut self) {
        let value = self.value.take();
        drop_guarded(self.what, value, |text| {
            self.host.log(LogLevel::ERROR, text);
        });
    }
}

/// Makes factories of one author type; `K` tells renderers, structures and loaders apart.
struct Factory<T, K> {
    id: String,
    kind: &'static str,
    types: PhantomData<fn() -> (T, K)>,
}

/// Marks a factory of renderers.
struct Renders;
/// Marks a factory of structures.
struct Structures;
/// Marks a factory of loaders.
struct Loads;

/// A factory of renderers of type `R`, for the manifest's entry `id`.
pub fn renderer_factory<R: Renderer>(id: &str) -> FactoryBox {
    let factory = Factory::<R, Renders> {
        id: id.into(),
        kind: "renderer",
        types: PhantomData,
    };
    FactoryObject_TO::from_value(factory, TD_Opaque)
}

/// A factory of structures of type `S`, for the manifest's entry `id`.
pub fn structure_factory<S: Structure>(id: &str) -> FactoryBox {
    let factory = Factory::<S, Structures> {
        id: id.into(),
        kind: "structure",
        types: PhantomData,
    };
    FactoryObject_TO::from_value(factory, TD_Opaque)
}

/// A factory of loaders of type `L`, for the manifest's entry `id`.
pub fn loader_factory<L: Loader>(id: &str) -> FactoryBox {
    let factory = Factory::<L, Loads> {
        id: id.into(),
        kind: "loader",
        types: PhantomData,
    };
    FactoryObject_TO::from_value(factory, TD_Opaque)
}

impl<R: Renderer> FactoryObject for Factory<R, Renders> {
    fn kind(&self) -> RString {
        self.kind.into()
    }

    fn id(&self) -> RString {
        self.id.as_str().into()
    }

    fn prepare_renderer(&self, call: &PrepareRecord<'_>) -> RResult<RendererBox, abi::ErrorRecord> {
        prepare_renderer::<R>(call, None)
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<abi::ExtensionBox> {
        no_extension()
    }
}

impl<S: Structure> FactoryObject for Factory<S, Structures> {
    fn kind(&self) -> RString {
        self.kind.into()
    }

    fn id(&self) -> RString {
        self.id.as_str().into()
    }

    fn prepare_structure(
        &self,
        call: &PrepareRecord<'_>,
    ) -> RResult<StructureBox, abi::ErrorRecord> {
        prepare_structure::<S>(call, None)
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<abi::ExtensionBox> {
        no_extension()
    }
}

impl<L: Loader> FactoryObject for Factory<L, Loads> {
    fn kind(&self) -> RString {
        self.kind.into()
    }

    fn id(&self) -> RString {
        self.id.as_str().into()
    }

    fn extension(&self, _name: RStr<'_>) -> ROption<abi::ExtensionBox> {
        no_extension()
    }

    fn loader(&self) -> RResult<LoaderBox, abi::ErrorRecord> {
        border("loader", || {
            let adapter = LoaderAdapter::<L>(PhantomData);
            Ok(LoaderObject_TO::from_value(adapter, TD_Opaque))
        })
    }
}

fn prepare_renderer<R: Renderer>(
    call: &PrepareRecord<'_>,
    previous: Option<&R>,
) -> RResult<RendererBox, abi::ErrorRecord> {
    border("prepare", || {
        let host = Host::new(abi::share_host(&call.host));
        let previous = previous.map(|previous| (previous, Changes::new(call.changes.as_slice())));
        let settings = Settings::new(call.settings.as_slice());
        let prepared = R::prepare(
            &host,
            Scene::new(call.scene),
            previous,
            settings,
            &Progress::new(&call.call),
        )?;
        let prepared = Prepared(Guarded::new(
            Arc::new(prepared),
            host,
            "the renderer's Drop",
        ));
        Ok(RendererObject_TO::from_value(prepared, TD_Opaque))
    })
}

fn prepare_structure<S: Structure>(
    call: &PrepareRecord<'_>,
    previous: Option<&S>,
) -> RResult<StructureBox, abi::ErrorRecord> {
    border("prepare", || {
        let host = Host::new(abi::share_host(&call.host));
        let previous = previous.map(|previous| (previous, Changes::new(call.changes.as_slice())));
        let settings = Settings::new(call.settings.as_slice());
        let built = S::prepare(
            &host,
            Scene::new(call.scene),
            previous,
            settings,
            &Progress::new(&call.call),
        )?;
        let built = Built(Guarded::new(Arc::new(built), host, "the structure's Drop"));
        Ok(StructureObject_TO::from_value(built, TD_Opaque))
    })
}

struct Prepared<R: Renderer>(Guarded<Arc<R>>);

impl<R: Renderer> RendererObject for Prepared<R> {
    fn prepare_next(&self, call: &PrepareRecord<'_>) -> RResult<RendererBox, abi::ErrorRecord> {
        prepare_renderer::<R>(call, Some(self.0.get().as_ref()))
    }

    fn view(&self, host: HostRef) -> RResult<ViewBox, abi::ErrorRecord> {
        border("view", || {
            let host = Host::new(host);
            let prepared = Arc::clone(self.0.get());
            let view = prepared.view(&host)?;
            let parts = Guarded::new((view, prepared), host, "the view's Drop");
            Ok(ViewObject_TO::from_value(
                ViewAdapter::<R>(parts),
                TD_Opaque,
            ))
        })
    }
}

/// The view before the renderer, so that it is dropped first.
struct ViewAdapter<R: Renderer>(Guarded<(R::View, Arc<R>)>);

impl<R: Renderer> ViewObject for ViewAdapter<R> {
    fn render(&mut self, frame: &mut FrameRecord<'_>) -> RResult<OutcomeRecord, abi::ErrorRecord> {
        let (view, prepared) = self.0.get_mut();
        border("render", || {
            let mut frame = Frame::new(frame);
            let outcome = view.render(prepared, &mut frame)?;
            Ok(frame.into_outcome(outcome))
        })
    }
}

struct Built<S: Structure>(Guarded<Arc<S>>);

impl<S: Structure> StructureObject for Built<S> {
    fn prepare_next(&self, call: &PrepareRecord<'_>) -> RResult<StructureBox, abi::ErrorRecord> {
        prepare_structure::<S>(call, Some(self.0.get().as_ref()))
    }

    fn blocks<'a>(&'a self) -> RResult<RVec<StructureBlockRecord<'a>>, abi::ErrorRecord> {
        border("blocks", || {
            let record = |block: crate::structure::OwnBlock<'a>| StructureBlockRecord {
                object: block.object,
                surfel_count: block.position_radius.len() as u32,
                columns: own_columns(&block).into(),
            };
            Ok(self.0.get().blocks().into_iter().map(record).collect())
        })
    }

    fn selector(&self, host: HostRef) -> RResult<SelectorBox, abi::ErrorRecord> {
        border("selector", || {
            let host = Host::new(host);
            let structure = Arc::clone(self.0.get());
            let selector = structure.selector(&host)?;
            let parts = Guarded::new((selector, structure), host, "the selector's Drop");
            Ok(SelectorObject_TO::from_value(
                SelectorAdapter::<S>(parts),
                TD_Opaque,
            ))
        })
    }
}

struct SelectorAdapter<S: Structure>(Guarded<(S::Selector, Arc<S>)>);

impl<S: Structure> SelectorObject for SelectorAdapter<S> {
    fn select(&mut self, view: &SelectRecord<'_>) -> RResult<SelectionRecord, abi::ErrorRecord> {
        let (selector, structure) = self.0.get_mut();
        border("select", || {
            Ok(selector.select(structure, &Query::new(view))?.into_record())
        })
    }
}

/// Pairs the manifest's entries with the factories, in order and by kind.
///
/// # Errors
/// If the manifest is not JSON, or has more or fewer entries of a kind than the `export!` line has types.
pub fn collect_factories(
    manifest: &[u8],
    renderers: &[fn(&str) -> FactoryBox],
    structures: &[fn(&str) -> FactoryBox],
    loaders: &[fn(&str) -> FactoryBox],
) -> RResult<RVec<FactoryBox>, abi::ErrorRecord> {
    border("export!", || {
        let ids = |kind: &str| entry_ids(manifest, kind);
        let mut factories = RVec::new();
        for (kind, makers) in [
            ("renderer", renderers),
            ("structure", structures),
            ("loader", loaders),
        ] {
            let ids = ids(kind)?;
            if ids.len() != makers.len() {
                return Err(format!(
                    "the manifest has {} entries of kind '{kind}', but export! names {} types; make them agree",
                    ids.len(),
                    makers.len()
                )
                .into());
            }
            factories.extend(ids.iter().zip(makers).map(|(id, make)| make(id)));
        }
        Ok(factories)
    })
}

/// Ids of the manifest's entries of one kind, in order.
fn entry_ids(manifest: &[u8], kind: &str) -> Result<Vec<String>> {
    #[derive(serde::Deserialize)]
    struct Entries {
        plugins: Vec<Entry>,
    }
    #[derive(serde::Deserialize)]
    struct Entry {
        kind: String,
        id: String,
    }
    let Entries { plugins } = serde_json::from_slice(manifest)
        .map_err(|error| format!("the embedded manifest is damaged: {error}"))?;
    Ok(plugins
        .into_iter()
        .filter(|entry| entry.kind == kind)
        .map(|entry| entry.id)
        .collect())
}
