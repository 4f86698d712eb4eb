use std::sync::Arc;

use glam::DVec3;
use pointstage_scene::{Block, Geometry, Job, LoadOptions, Origins, load};

use super::*;

fn object(name: &str, x: f32) -> Object {
    let block = Block {
        position_radius: Arc::from([[x, 0.0, 0.0, 0.5]]),
        ..Block::default()
    };
    let geometry = Geometry::new(vec![block], None, Origins::default());
    Object::new(name, DVec3::ZERO, geometry)
}

fn folder() -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = std::fs::canonicalize(folder.path()).expect("it is there");
    (folder, path)
}

fn x_in(file: &Path) -> f64 {
    let loaded = load(file, &LoadOptions::default(), &Job::new()).expect("it can be read");
    loaded.object.bounds_world().centre().x
}

#[test]
fn objects_of_one_name_get_files_of_their_own_beside_the_session() {
    let (_kept, folder) = folder();
    let session = folder.join("work.pointstage.toml");
    let objects = [object("a/b", 1.0), object("a/b", 2.0), object("", 3.0)];
    let places = OwnFiles::default().places(&objects, &session);
    let files = objects.map(|object| places[&object.id.0].clone());
    let of = |name: &str| folder.join("work.objects").join(name);
    assert_eq!(files, [of("a_b.ply"), of("a_b 2.ply"), of("object.ply")]);
    assert!(files.iter().all(|file| is_own(file)));
    assert!(!is_own(Path::new("/scans/a.ply")));
}

#[test]
fn surfels_that_a_file_holds_are_not_written_again_and_others_do_not_take_it() {
    let (_kept, folder) = folder();
    let session = folder.join("work.pointstage.toml");
    let files = OwnFiles::default();
    let first = object("a", 1.0);
    let save = |objects: &[Object]| {
        let places = files.places(objects, &session);
        for object in objects {
            let file = places[&object.id.0].clone();
            let object = object.clone();
            files.write(&OwnObject { object, file }).expect("written");
        }
        places
    };
    let at = save(std::slice::from_ref(&first))[&first.id.0].clone();
    // Somebody else's change shows whether it is written again.
    std::fs::write(&at, "changed").expect("written");
    assert_eq!(save(std::slice::from_ref(&first))[&first.id.0], at);
    assert_eq!(std::fs::read(&at).expect("there"), b"changed");
    // Another object of that name beside it, in front of it.
    let second = object("a", 2.0);
    let both = save(&[second.clone(), first.clone()]);
    assert_eq!(both[&first.id.0], at);
    assert_eq!(x_in(&both[&second.id.0]), 2.0);
}

#[test]
fn an_object_whose_file_was_written_anew_is_not_in_it_any_more() {
    let (_kept, folder) = folder();
    let file = folder.join("work.objects/a.ply");
    let files = OwnFiles::default();
    let own = |object: &Object| OwnObject {
        object: object.clone(),
        file: file.clone(),
    };
    files.write(&own(&object("a", 1.0))).expect("written");
    let loaded = load(&file, &LoadOptions::default(), &Job::new()).expect("it can be read");
    let OwnFiles(known) = &files;
    known.lock().expect("nobody panicked").clear();
    assert!(files.hold(&loaded.object), "as a new start finds it");
    let mut edited = loaded.object.clone();
    edited.geometry = object("a", 2.0).geometry;
    assert!(!files.hold(&edited));
    files.write(&own(&edited)).expect("written");
    // Undo brings back the object as it was.
    assert!(!files.hold(&loaded.object));
}

#[test]
fn where_it_stands_and_its_radius_scale_are_left_to_the_session() {
    let (_kept, folder) = folder();
    let file = folder.join("a.ply");
    let mut object = object("a", 1.0);
    object.world_from_object = DAffine3::from_translation(DVec3::X);
    object.radius_scale = 4.0;
    let geometry = Arc::make_mut(&mut object.geometry);
    geometry.origins.radii = pointstage_scene::Provenance::FromFile;
    let files = OwnFiles::default();
    let own = OwnObject {
        object,
        file: file.clone(),
    };
    files.write(&own).expect("written");
    let loaded = load(&file, &LoadOptions::default(), &Job::new()).expect("it can be read");
    let [.., radius] = loaded.object.geometry.blocks[0].position_radius[0];
    assert_eq!((x_in(&file), radius), (1.0, 0.5));
}
