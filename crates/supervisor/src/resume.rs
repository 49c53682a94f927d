//! What a run keeps about itself that whoever takes it up again must know. Knows the run's folder, and no runner.

use crate::remains;
use rafcon_protocol::{Crash, Launch, OnCrash, Resume};
use rafcon_storage::journal::About;
use std::path::{Path, PathBuf};

/// The launch that takes up the run in `folder`: as `policy` says, from the end or from the event `from`.
pub fn resume_launch(folder: &Path, policy: OnCrash, from: Option<u64>) -> Launch {
    Launch {
        machine: machine_of(folder),
        run_folder: Some(folder.to_path_buf()),
        resume: Some(Resume { policy, from }),
        crash: Some(Crash {
            reason: "its runner ended before the run did".to_owned(),
            active: remains::running(folder),
        }),
        listen: true,
        ..Launch::default()
    }
}

/// Where the machine of a run was, as the run keeps it; an empty path if it does not say.
pub fn machine_of(folder: &Path) -> PathBuf {
    let about = about(folder);
    let machine = about.as_ref().and_then(|about| about.get("machine")?.as_str());
    machine.map(PathBuf::from).unwrap_or_default()
}

/// What becomes of scripts that a crash has interrupted, as the run keeps it.
pub fn policy_of(folder: &Path) -> OnCrash {
    about(folder)
        .and_then(|about| serde_json::from_value(about.get("on_crash")?.clone()).ok())
        .unwrap_or_default()
}

/// What a run says about itself; nothing if its file is missing or damaged.
fn about(folder: &Path) -> Option<serde_json::Value> {
    About::json(folder).ok()
}

#[cfg(test)]
mod tests {
    use super::{policy_of, resume_launch};
    use expect_test::{Expect, expect};
    use rafcon_protocol::OnCrash;

    fn check(about: Option<&str>, expect: &Expect) {
        let folder = tempfile::tempdir().unwrap();
        if let Some(about) = about {
            std::fs::write(folder.path().join("run.json"), about).unwrap();
        }
        let launch = resume_launch(folder.path(), OnCrash::Restart, Some(7));
        assert_eq!(launch.run_folder.as_deref(), Some(folder.path()));
        let facts = (launch.machine, launch.resume, launch.listen, policy_of(folder.path()));
        expect.assert_eq(&format!("{facts:?}"));
    }

    #[test]
    fn a_run_is_taken_up_as_it_says_itself() {
        check(
            Some(r#"{"machine": "/m/pick", "on_crash": "abort"}"#),
            &expect![[
                r#"("/m/pick", Some(Resume { policy: Restart, from: Some(7) }), true, Abort)"#
            ]],
        );
    }

    #[test]
    fn a_run_that_says_nothing_asks() {
        let nothing =
            &expect![[r#"("", Some(Resume { policy: Restart, from: Some(7) }), true, Ask)"#]];
        for about in [None, Some("{"), Some("{}"), Some(r#"{"on_crash": "dance"}"#)] {
            check(about, nothing);
        }
    }
}
