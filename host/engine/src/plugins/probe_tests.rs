use super::*;
use std::os::unix::fs::PermissionsExt as _;

/// A program that behaves as `script` says, in place of the real one.
fn program(folder: &Path, script: &str) -> ChildProgram {
    let path = folder.join("program");
    std::fs::write(&path, format!("#!/bin/sh\n{script}\n")).expect("writable");
    let permissions = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(&path, permissions).expect("own file");
    ChildProgram {
        program: path,
        check_limit: Duration::from_mins(1),
        trial_limit: Duration::from_mins(1),
    }
}

fn class_of(script: &str) -> Verdict {
    let folder = tempfile::tempdir().expect("a temporary folder");
    check_file(
        &program(folder.path(), script),
        Path::new("/plugins/libdots.so"),
    )
    .verdict
}

#[test]
fn an_answer_is_taken_as_it_is() {
    let ok = r#"echo noise; echo 'pointstage-verdict {"verdict":{"class":"ok","message":""},"api":"1.0.0"}'"#;
    assert_eq!(class_of(ok).class, VerdictClass::Ok);
    let no = r#"echo 'pointstage-verdict {"verdict":{"class":"rejected","message":"no"}}'"#;
    assert_eq!(class_of(no), Verdict::rejected("no"));
}

#[test]
fn a_signal_is_a_crash_and_names_it() {
    let verdict = class_of("echo last words >&2; kill -SEGV $$");
    assert_eq!(verdict.class, VerdictClass::Crashed);
    assert!(
        verdict.message.contains("libdots.so") && verdict.message.contains("SIGSEGV"),
        "{}",
        verdict.message
    );
    assert!(verdict.detail.contains("last words"), "{}", verdict.detail);
}

#[test]
fn silence_is_an_odd_exit_whatever_the_code() {
    for script in ["exit 0", "exit 1", "echo hello"] {
        assert_eq!(class_of(script).class, VerdictClass::OddExit, "{script}");
    }
}

#[test]
fn an_answer_before_a_crash_does_not_count() {
    let script =
        r#"echo 'pointstage-verdict {"verdict":{"class":"ok","message":""}}'; kill -ABRT $$"#;
    assert_eq!(class_of(script).class, VerdictClass::Crashed);
}

#[test]
fn no_end_in_time_is_a_hang() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut program = program(folder.path(), "exec sleep 600");
    program.check_limit = Duration::from_millis(200);
    let verdict = check_file(&program, Path::new("libdots.so")).verdict;
    assert_eq!(verdict.class, VerdictClass::Hung);
}

#[test]
fn much_output_does_not_block_the_child() {
    let script = "yes | head -c 3000000; yes | head -c 3000000 >&2; exit 3";
    assert_eq!(class_of(script).class, VerdictClass::OddExit);
}

#[test]
fn a_program_that_does_not_run_says_nothing_about_the_plugin() {
    let program = ChildProgram::new("/no/such/program".into());
    let verdict = check_file(&program, Path::new("libdots.so")).verdict;
    assert_eq!(verdict.class, VerdictClass::NotExamined);
    assert!(verdict.is_usable());
}

#[test]
fn a_fault_of_the_control_run_is_not_the_plugins() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = program(folder.path(), "kill -SEGV $$");
    let request = TrialRequest {
        plugin: Some(("libdots.so".into(), "a.b".into())),
        ..TrialRequest::default()
    };
    let mut control = None;
    let verdict = try_plugin(&program, &request, &mut control);
    assert_eq!(verdict.class, VerdictClass::NotExamined);
    assert!(
        verdict.message.contains("without any plugin"),
        "{}",
        verdict.message
    );
    assert_eq!(
        control.map(|control| control.class),
        Some(VerdictClass::Crashed)
    );
}

#[test]
fn a_crash_after_a_good_control_run_is_the_plugins() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let script = r#"case "$3" in *libdots*) kill -SEGV $$;; esac
echo 'pointstage-verdict {"verdict":{"class":"ok","message":""}}'"#;
    let program = program(folder.path(), script);
    let request = TrialRequest {
        plugin: Some(("libdots.so".into(), "a.b".into())),
        ..TrialRequest::default()
    };
    let verdict = try_plugin(&program, &request, &mut None);
    assert_eq!(verdict.class, VerdictClass::Crashed);
}
