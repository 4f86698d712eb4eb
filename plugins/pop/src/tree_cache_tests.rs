use super::*;

#[test]
fn the_folder_is_the_users_cache() {
    if cfg!(target_os = "linux") {
        let home = |name: &str| (name == "HOME").then(|| PathBuf::from("/home/me"));
        assert_eq!(folder(home), Some("/home/me/.cache/pointstage/pop".into()));
        let own = |name: &str| (name == "XDG_CACHE_HOME").then(|| PathBuf::from("/own"));
        assert_eq!(folder(own), Some("/own/pointstage/pop".into()));
        let relative = |name: &str| (name == "XDG_CACHE_HOME").then(|| PathBuf::from("own"));
        assert_eq!(folder(relative), None);
    }
}

#[test]
fn the_oldest_files_go_until_the_rest_fits() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, age: u64| {
        let path = folder.path().join(name);
        std::fs::write(&path, [0; 100]).unwrap();
        let time = SystemTime::now() - std::time::Duration::from_secs(age);
        std::fs::File::options()
            .write(true)
            .open(&path)
            .unwrap()
            .set_modified(time)
            .unwrap();
        path
    };
    let oldest = write("a.pop", 30);
    let kept = write("b.pop", 20);
    let old = write("c.pop", 10);
    let new = write("d.pop", 1);
    let other = write("notes.txt", 40);
    forget_oldest(folder.path(), &kept, 250);
    let left = [&oldest, &kept, &old, &new, &other].map(|path| path.exists());
    assert_eq!(left, [false, true, false, true, true]);
}
