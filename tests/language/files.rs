//! The one door to files: nothing outside of the root, and a record of what was read.

use kiln::language::source::{DiskFiles, FileError, Files, MemoryFiles, join};

#[test]
fn disk_files_stay_inside_the_root() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("project");
    std::fs::create_dir_all(root.join("sub")).unwrap();
    std::fs::write(root.join("a.toml"), "a").unwrap();
    std::fs::write(folder.path().join("secret"), "s").unwrap();
    let files = DiskFiles::new(&root).unwrap();
    assert_eq!(&*files.read("a.toml").unwrap(), b"a");
    assert_eq!(&*files.read("sub/../a.toml").unwrap(), b"a");
    assert_eq!(files.read("../secret"), Err(FileError::Outside));
    assert_eq!(files.read("sub/../../secret"), Err(FileError::Outside));
    assert_eq!(files.read("/etc/passwd"), Err(FileError::Absolute));
    assert_eq!(files.read("none"), Err(FileError::Missing));
    assert_eq!(files.read("a.toml/b"), Err(FileError::Missing));
    assert_eq!(files.read("sub"), Err(FileError::Folder));
    let record: Vec<_> = files.record().into_iter().map(|one| (one.path, one.found)).collect();
    assert_eq!(record.iter().filter(|(_, found)| *found).count(), 2);
    assert!(record.contains(&("none".to_owned(), false)));
    assert!(DiskFiles::new(root.join("a.toml")).is_err());
}

#[cfg(unix)]
#[test]
fn links_that_lead_out_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("project");
    std::fs::create_dir(&root).unwrap();
    std::fs::write(folder.path().join("secret"), "s").unwrap();
    std::fs::write(root.join("inside"), "i").unwrap();
    std::os::unix::fs::symlink("../secret", root.join("out")).unwrap();
    std::os::unix::fs::symlink("..", root.join("up")).unwrap();
    std::os::unix::fs::symlink("inside", root.join("in")).unwrap();
    std::os::unix::fs::symlink("loop", root.join("loop")).unwrap();
    let files = DiskFiles::new(&root).unwrap();
    assert_eq!(files.read("out"), Err(FileError::Outside));
    assert_eq!(files.read("up/secret"), Err(FileError::Outside));
    assert_eq!(&*files.read("in").unwrap(), b"i");
    assert!(matches!(files.read("loop"), Err(FileError::Unreadable(_))));
    assert!(matches!(DiskFiles::new("/dev").unwrap().read("null"), Err(FileError::Unreadable(_))));
}

#[test]
fn paths_are_found_from_the_file_that_writes_them() {
    assert_eq!(join("a/b/main.toml", "../c/d.png").as_deref(), Ok("a/c/d.png"));
    assert_eq!(join("main.toml", "./d.png").as_deref(), Ok("d.png"));
    assert_eq!(join("a/main.toml", "../../d.png"), Err(FileError::Outside));
    for absolute in ["/a", "\\a", "c:a", "C:\\a", "\\\\server\\share"] {
        assert_eq!(join("main.toml", absolute), Err(FileError::Absolute), "{absolute}");
    }
    for odd in ["a\\b", "ab:c", "a\nb", "a?b", "nul", "sub/CON.txt", "lpt1", "a /b", "b."] {
        assert_eq!(join("main.toml", odd), Err(FileError::NotPortable), "{odd}");
    }
    assert_eq!(join("main.toml", ""), Err(FileError::Folder));
    assert_eq!(join("main.toml", "console/comet.png").as_deref(), Ok("console/comet.png"));
}

#[test]
fn memory_files_serve_what_they_were_given() {
    let files = MemoryFiles::new().with("a", "1").with("a", "2");
    assert_eq!(&*files.read("./a").unwrap(), b"2");
    assert_eq!(files.read("b"), Err(FileError::Missing));
}
