//! Files that a model uses, as they are on a disk: what is wrong with one is one finding at the `use` that names it. See
//! spec.md#components-of-other-files.

use std::fs;
use std::path::Path;
use std::process::Command;

const GOOD: &str =
    "component c(m = 1 kg) {\n  body b { mass = m, moves x }\n  spring s: ground -- b { k = 1 N/m }\n}\n";

/// Exit status and findings of a model in a folder, `file:line:column: severity[code]` each.
fn checked(folder: &Path, model: &str) -> (Option<i32>, Vec<String>) {
    fs::write(folder.join("m.vib"), model).expect("a model");
    let run = Command::new(env!("CARGO_BIN_EXE_vibc"))
        .args(["check", "m.vib", "--message-format", "short"])
        .current_dir(folder)
        .output()
        .expect("the program starts");
    let said = String::from_utf8_lossy(&run.stderr).into_owned();
    let place = |line: &str| line.split("]: ").next().map(|head| format!("{head}]"));
    (run.status.code(), said.lines().filter_map(place).collect())
}

const SCENE: &str =
    "use \"part.vib\"\nplace a = c()\nbody d { mass = 1 kg, moves x }\nspring t: ground -- d { k = 2 N/m }\n";

#[test]
fn a_file_that_cannot_be_read_is_one_finding_at_its_use() {
    let unreadable = (Some(3), vec!["m.vib:1:5: error[vib::use::unreadable]".to_string()]);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let part = folder.path().join("part.vib");
    assert_eq!(checked(folder.path(), SCENE), unreadable, "missing");

    fs::create_dir(&part).expect("a folder");
    assert_eq!(checked(folder.path(), SCENE), unreadable, "a folder");
    fs::remove_dir(&part).expect("a folder");

    fs::write(&part, b"\x7fELF\x02\x01\x01\x00\xff\xfe\xfd").expect("a file");
    assert_eq!(checked(folder.path(), SCENE), unreadable, "binary");

    fs::write(&part, format!("{GOOD}{}", "// a comment of a line\n".repeat((60 << 20) / 23))).expect("a file");
    assert_eq!(checked(folder.path(), SCENE), unreadable, "60 MB");

    fs::write(&part, GOOD).expect("a file");
    assert_eq!(checked(folder.path(), SCENE), (Some(0), Vec::new()));
    let outside = SCENE.replace("part.vib", "../part.vib");
    assert_eq!(checked(folder.path(), &outside), unreadable, "outside");
    let other = SCENE.replace("part.vib", "part.txt");
    fs::write(folder.path().join("part.txt"), GOOD).expect("a file");
    assert_eq!(checked(folder.path(), &other), unreadable, "of another kind");
}

/// A pipe that nobody writes into, and devices without an end: the program ends all the same.
#[cfg(unix)]
#[test]
fn pipes_and_devices_are_not_read() {
    let unreadable = (Some(3), vec!["m.vib:1:5: error[vib::use::unreadable]".to_string()]);
    let folder = tempfile::tempdir().expect("a temporary folder");
    let part = folder.path().join("part.vib");
    let made = Command::new("mkfifo").arg(&part).status().expect("mkfifo");
    assert!(made.success());
    assert_eq!(checked(folder.path(), SCENE), unreadable, "a pipe");
    fs::remove_file(&part).expect("a pipe");
    for device in ["/dev/zero", "/dev/stdin"] {
        std::os::unix::fs::symlink(device, &part).expect("a link");
        assert_eq!(checked(folder.path(), SCENE), unreadable, "{device}");
        fs::remove_file(&part).expect("a link");
        let named = SCENE.replace("part.vib", device);
        assert_eq!(checked(folder.path(), &named), unreadable, "{device}");
    }
}

#[test]
fn files_that_use_each_other_are_one_finding() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("part.vib", &format!("use \"other.vib\"\n{GOOD}"));
    write("other.vib", &format!("use \"part.vib\"\n{}", GOOD.replace("component c", "component d")));
    let cycle = |place: &str| (Some(1), vec![format!("{place}: error[vib::use::cycle]")]);
    assert_eq!(checked(folder.path(), SCENE), cycle("other.vib:1:5"));
    write("part.vib", &format!("use \"m.vib\"\n{GOOD}"));
    assert_eq!(checked(folder.path(), SCENE), cycle("part.vib:1:5"));
    write("part.vib", &format!("use \"part.vib\"\n{GOOD}"));
    assert_eq!(checked(folder.path(), SCENE), cycle("part.vib:1:5"));
    // By a link it is the same file.
    #[cfg(unix)]
    {
        write("part.vib", &format!("use \"link.vib\"\n{GOOD}"));
        std::os::unix::fs::symlink("part.vib", folder.path().join("link.vib")).expect("a link");
        assert_eq!(checked(folder.path(), SCENE), cycle("part.vib:1:5"));
    }
}

/// Components that contain each other, each in a file of its own: each file uses the other one, which is the mistake.
#[test]
fn two_components_of_one_name_are_one_finding_that_names_both() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("part.vib", GOOD);
    write("more.vib", GOOD);
    let twice = |place: &str| (Some(1), vec![format!("{place}: error[vib::component::duplicate]")]);
    assert_eq!(checked(folder.path(), &format!("{SCENE}use \"more.vib\"\n")), twice("m.vib:5:5"));
    assert_eq!(checked(folder.path(), &format!("{SCENE}{GOOD}")), twice("m.vib:5:11"));
    // Named twice, a file is read once.
    assert_eq!(checked(folder.path(), &format!("{SCENE}use \"./part.vib\"\n")), (Some(0), Vec::new()));
    // In one file.
    let both = format!("{GOOD}{GOOD}place a = c()\n");
    assert_eq!(checked(folder.path(), &both), twice("m.vib:5:11"));
}

#[test]
fn a_mistake_in_a_used_file_points_there_once() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("part.vib"), GOOD.replace("mass = m", "mass = q")).expect("a file");
    let six: String = (1..=6).map(|number| format!("place p{number} = c()\n")).collect();
    let found = checked(folder.path(), &format!("use \"part.vib\"\n{six}"));
    assert_eq!(found, (Some(1), vec!["part.vib:2:19: error[vib::name::unknown]".to_string()]));
    // The same if nothing is placed.
    let found = checked(
        folder.path(),
        "use \"part.vib\"\nbody d { mass = 1 kg, moves x }\nspring t: ground -- d { k = 2 N/m }\n",
    );
    assert_eq!(found, (Some(1), vec!["part.vib:2:19: error[vib::name::unknown]".to_string()]));
    // What only one place causes is said at that place.
    fs::write(folder.path().join("part.vib"), GOOD).expect("a file");
    let found = checked(folder.path(), &format!("use \"part.vib\"\n{six}place bad = c(m = -1 kg)\n"));
    assert_eq!(found, (Some(1), vec!["m.vib:8:19: error[vib::value::negative]".to_string()]));
}
