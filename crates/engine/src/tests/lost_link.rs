//! Lost link: the effects of states' policies, and their limits.

use super::{check, check_change};
use expect_test::expect;

const DRIVE: &str = r#"
hierarchy ROOT
  outcome done
  start -> DRIVE ; DRIVE.ok -> SAMPLE ; SAMPLE.ok -> .done
  semantic {"lost_link": {"hold_s": 0.03}}
  execution DRIVE
    outcome ok
  hierarchy SAMPLE
    outcome ok
    start -> A ; A.ok -> B ; B.ok -> .ok
    semantic {"instrument": "drill"}
    execution A
      outcome ok
    execution B
      outcome ok
"#;

/// The machine with this policy of the state SAMPLE.
fn sample(policy: &str) -> String {
    DRIVE.replace(r#""instrument": "drill""#, &format!("\"lost_link\": {policy}"))
}

#[test]
fn no_state_begins_that_is_to_be_held() {
    check(
        DRIVE,
        "start; silence 29; silence 30; DRIVE ok; active; silence 0; resume; A ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 29
        > silence 30
        > DRIVE ok
        leave ROOT/DRIVE ok
        hold ROOT before ROOT/SAMPLE (Loss(Link))
        > active
        ROOT Held (Loss(Link) before ROOT/SAMPLE)
        Stepping, 2 states run
        > silence 0
        > resume
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
        > A ok
        leave ROOT/SAMPLE/A ok
        enter ROOT/SAMPLE/B
          run ROOT/SAMPLE/B
    "]],
    );
}

#[test]
fn a_state_that_is_to_continue_does() {
    let machine = &sample(r#""continue""#);
    check(
        machine,
        "start; DRIVE ok; silence 30; A ok; B ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > DRIVE ok
        leave ROOT/DRIVE ok
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
        > silence 30
        > A ok
        leave ROOT/SAMPLE/A ok
        enter ROOT/SAMPLE/B
          run ROOT/SAMPLE/B
        > B ok
        leave ROOT/SAMPLE/B ok
        leave ROOT/SAMPLE ok
        leave ROOT done
        finished
          end of run: done (0), 5 states
    "]],
    );
}

#[test]
fn what_is_held_waits_for_a_command() {
    check(
        DRIVE,
        "start; silence 60; DRIVE ok; silence 0; active; step into",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        hold ROOT before ROOT/SAMPLE (Loss(Link))
        > silence 0
        > active
        ROOT Held (Loss(Link) before ROOT/SAMPLE)
        Stepping, 2 states run
        > step into
        enter ROOT/SAMPLE
        hold ROOT/SAMPLE before ROOT/SAMPLE/A (Step)
    "]],
    );
}

#[test]
fn a_state_ends_before_its_branch_is_held() {
    let machine = &sample(r#"{"finish_s": 0.03}"#);
    check(
        machine,
        "start; DRIVE ok; silence 60; A ok; B ok; active; resume",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > DRIVE ok
        leave ROOT/DRIVE ok
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
        > silence 60
        > A ok
        leave ROOT/SAMPLE/A ok
        enter ROOT/SAMPLE/B
          run ROOT/SAMPLE/B
        > B ok
        leave ROOT/SAMPLE/B ok
        leave ROOT/SAMPLE ok
        hold ROOT (Loss(Link))
        > active
        ROOT Held (Loss(Link))
        Stepping, 5 states run
        > resume
        leave ROOT done
        finished
          end of run: done (0), 5 states
    "]],
    );
}

#[test]
fn the_time_since_the_last_command_counts_by_itself() {
    let machine = &DRIVE.replace("lost_link", "lost_command");
    check(
        machine,
        "start; silence 60; silence command 60; DRIVE ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > silence command 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        hold ROOT before ROOT/SAMPLE (Loss(Command))
    "]],
    );
}

const RECOVER: &str = r#"
hierarchy ROOT
  outcome done
  start -> DRIVE ; DRIVE.preempted -> HOME ; HOME.ok -> DRIVE ; DRIVE.ok -> .done
  barrier DRIVE
    outcome ok
    semantic {"lost_link": {"recover_s": 0.03}}
    unique_decider_state_id.ok -> .ok
    hierarchy ARM
      outcome ok
      start -> A ; A.ok -> B ; B.ok -> .ok
      execution A
        outcome ok
        semantic {"lost_link": "continue"}
      execution B
        outcome ok
    hierarchy WHEELS
      outcome ok
      start -> C ; C.ok -> D ; D.ok -> .ok
      execution C
        outcome ok
      execution D
        outcome ok
    decider unique_decider_state_id
      outcome ok
  execution HOME
    outcome ok
"#;

#[test]
fn a_state_is_preempted_and_its_outcome_leads_home() {
    check(
        RECOVER,
        "start; A ok; silence 30; B preempted; C preempted; HOME ok; active",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
        enter ROOT/DRIVE/ARM
        enter ROOT/DRIVE/ARM/A
        enter ROOT/DRIVE/WHEELS
        enter ROOT/DRIVE/WHEELS/C
          fork 1
          run ROOT/DRIVE/ARM/A on 1
          fork 2
          run ROOT/DRIVE/WHEELS/C on 2
        > A ok
        leave ROOT/DRIVE/ARM/A ok
        enter ROOT/DRIVE/ARM/B
          run ROOT/DRIVE/ARM/B on 1
        > silence 30
        lost_link preempts ROOT/DRIVE
          preempt ROOT/DRIVE
          preempt ROOT/DRIVE/ARM
          preempt ROOT/DRIVE/ARM/B
          preempt ROOT/DRIVE/WHEELS
          preempt ROOT/DRIVE/WHEELS/C
        > B preempted
        leave ROOT/DRIVE/ARM/B preempted
        leave ROOT/DRIVE/ARM preempted
          end 1
        > C preempted
        leave ROOT/DRIVE/WHEELS/C preempted
        leave ROOT/DRIVE/WHEELS preempted
        leave ROOT/DRIVE preempted
        enter ROOT/HOME
          end 2
          run ROOT/HOME
        > HOME ok
        leave ROOT/HOME ok
        hold ROOT before ROOT/DRIVE (Loss(Link))
        > active
        ROOT Held (Loss(Link) before ROOT/DRIVE)
        Stepping, 8 states run
    "]],
    );
}

#[test]
fn a_state_inside_with_a_policy_of_its_own_ends_first() {
    check(
        RECOVER,
        "start; silence 30; C ok; active; A ok; HOME ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
        enter ROOT/DRIVE/ARM
        enter ROOT/DRIVE/ARM/A
        enter ROOT/DRIVE/WHEELS
        enter ROOT/DRIVE/WHEELS/C
          fork 1
          run ROOT/DRIVE/ARM/A on 1
          fork 2
          run ROOT/DRIVE/WHEELS/C on 2
        > silence 30
        > C ok
        leave ROOT/DRIVE/WHEELS/C ok
        hold ROOT/DRIVE/WHEELS before ROOT/DRIVE/WHEELS/D (Loss(Link))
        > active
        ROOT Inside
        ROOT/DRIVE Inside
        ROOT/DRIVE/ARM Inside
        ROOT/DRIVE/ARM/A Script
        ROOT/DRIVE/WHEELS Held (Loss(Link) before ROOT/DRIVE/WHEELS/D)
        Stepping, 6 states run
        > A ok
        leave ROOT/DRIVE/ARM/A ok
        hold ROOT/DRIVE/ARM before ROOT/DRIVE/ARM/B (Loss(Link))
        lost_link preempts ROOT/DRIVE
        leave ROOT/DRIVE/ARM preempted
        leave ROOT/DRIVE/WHEELS preempted
        leave ROOT/DRIVE preempted
        enter ROOT/HOME
          preempt ROOT/DRIVE
          preempt ROOT/DRIVE/ARM
          preempt ROOT/DRIVE/WHEELS
          end 1
          end 2
          run ROOT/HOME
        > HOME ok
        leave ROOT/HOME ok
        hold ROOT before ROOT/DRIVE (Loss(Link))
    "]],
    );
}

#[test]
fn what_was_held_first_goes_home_all_the_same() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> DRIVE ; DRIVE.preempted -> HOME ; HOME.ok -> .done
  hierarchy DRIVE
    outcome ok
    semantic {\"lost_link\": {\"hold_s\": 0.01, \"recover_s\": 0.03}}
    start -> A ; A.ok -> B ; B.ok -> .ok
    execution A
      outcome ok
    execution B
      outcome ok
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 10; A ok; silence 30; HOME ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
        enter ROOT/DRIVE/A
          run ROOT/DRIVE/A
        > silence 10
        > A ok
        leave ROOT/DRIVE/A ok
        hold ROOT/DRIVE before ROOT/DRIVE/B (Loss(Link))
        > silence 30
        lost_link preempts ROOT/DRIVE
        leave ROOT/DRIVE preempted
        enter ROOT/HOME
          preempt ROOT/DRIVE
          run ROOT/HOME
        > HOME ok
        leave ROOT/HOME ok
        leave ROOT done
        finished
          end of run: done (0), 4 states
    "]],
    );
}

#[test]
fn a_stop_ends_what_is_held_for_want_of_a_link() {
    check(
        DRIVE,
        "start; silence 60; DRIVE ok; stop",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        hold ROOT before ROOT/SAMPLE (Loss(Link))
        > stop
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2), 2 states
    "]],
    );
}

#[test]
fn a_run_that_is_resumed_in_the_silence_is_held_again() {
    check(
        DRIVE,
        "start; silence 60; DRIVE ok; cut again",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        hold ROOT before ROOT/SAMPLE (Loss(Link))
        > cut again
        enter ROOT
        hold ROOT before ROOT/SAMPLE (Loss(Link))
    "]],
    );
}

#[test]
fn a_run_that_is_resumed_is_held_again_after_the_state_that_was_to_end() {
    let machine = &sample(r#"{"finish_s": 0.03}"#);
    check(
        machine,
        "start; DRIVE ok; silence 60; A ok; B ok; cut again; resume",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > DRIVE ok
        leave ROOT/DRIVE ok
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
        > silence 60
        > A ok
        leave ROOT/SAMPLE/A ok
        enter ROOT/SAMPLE/B
          run ROOT/SAMPLE/B
        > B ok
        leave ROOT/SAMPLE/B ok
        leave ROOT/SAMPLE ok
        hold ROOT (Loss(Link))
        > cut again
        enter ROOT
        hold ROOT (Loss(Link))
        > resume
        leave ROOT done
        finished
          end of run: done (0), 5 states
    "]],
    );
}

#[test]
fn branches_that_had_ended_are_held_again_before_they_count() {
    let wheels = "    hierarchy WHEELS\n      outcome ok\n";
    let ends_first = format!("{wheels}      semantic {{\"lost_link\": {{\"finish_s\": 0.03}}}}\n");
    let machine = &RECOVER.replace("recover_s", "hold_s").replace(wheels, &ends_first);
    check(
        machine,
        "start; A ok; B ok; silence 29; C ok; silence 60; D ok; active; cut again; active; resume",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/DRIVE
            enter ROOT/DRIVE/ARM
            enter ROOT/DRIVE/ARM/A
            enter ROOT/DRIVE/WHEELS
            enter ROOT/DRIVE/WHEELS/C
              fork 1
              run ROOT/DRIVE/ARM/A on 1
              fork 2
              run ROOT/DRIVE/WHEELS/C on 2
            > A ok
            leave ROOT/DRIVE/ARM/A ok
            enter ROOT/DRIVE/ARM/B
              run ROOT/DRIVE/ARM/B on 1
            > B ok
            leave ROOT/DRIVE/ARM/B ok
            leave ROOT/DRIVE/ARM ok
              end 1
            > silence 29
            > C ok
            leave ROOT/DRIVE/WHEELS/C ok
            enter ROOT/DRIVE/WHEELS/D
              run ROOT/DRIVE/WHEELS/D on 2
            > silence 60
            > D ok
            leave ROOT/DRIVE/WHEELS/D ok
            leave ROOT/DRIVE/WHEELS ok
            hold ROOT/DRIVE (Loss(Link))
            > active
            ROOT Inside
            ROOT/DRIVE Inside (Loss(Link))
            Stepping, 8 states run
            > cut again
            enter ROOT
            enter ROOT/DRIVE
            hold ROOT/DRIVE (Loss(Link))
              fork 1
            > active
            ROOT Inside
            ROOT/DRIVE Inside (Loss(Link))
            Stepping, 8 states run
            > resume
            enter ROOT/DRIVE/unique_decider_state_id
              end 1
              run ROOT/DRIVE/unique_decider_state_id [ARM ok] [WHEELS ok]
        "]],
    );
}

#[test]
fn a_changed_policy_counts_at_once() {
    let next = &DRIVE.replace("0.03", "3600");
    check_change(
        DRIVE,
        next,
        "start; silence 60; change; DRIVE ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > change
        changed
        > DRIVE ok
        leave ROOT/DRIVE ok
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
    "]],
    );
}

#[test]
fn a_breakpoint_goes_on_without_the_ground() {
    let machine = &DRIVE.replace("hold_s", "finish_s");
    let script =
        "break 1 before ROOT/SAMPLE continue lost 50; start; DRIVE ok; silence 49; silence 50";
    check(
        machine,
        script,
        &expect![[r"
        > break 1 before ROOT/SAMPLE continue lost 50
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > DRIVE ok
        leave ROOT/DRIVE ok
        hit 1 at ROOT/SAMPLE for the 1. time
        hold ROOT before ROOT/SAMPLE (Breakpoint(1))
        > silence 49
        > silence 50
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
    "]],
    );
}

#[test]
fn a_breakpoint_stops_the_run_without_the_ground() {
    let machine = &DRIVE.replace("hold_s", "finish_s");
    check(
        machine,
        "break 1 after ROOT/DRIVE stop lost 50; start; silence 60; DRIVE ok",
        &expect![[r"
        > break 1 after ROOT/DRIVE stop lost 50
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        hit 1 at ROOT/DRIVE for the 1. time, goes on
        stopping
        leave ROOT preempted
        finished
          preempt ROOT
          end of run: preempted (-2), 2 states
    "]],
    );
}

/// A machine whose work has this policy. Its recovery stows the arm, then the robot goes home.
fn work(policy: &str) -> String {
    WORK.replace("POLICY", &format!("semantic {{\"lost_link\": {policy}}}"))
}

const WORK: &str = "
hierarchy ROOT
  outcome done
  start -> WORK ; WORK.preempted -> HOME ; WORK.aborted -> HOME ; WORK.ok -> .done ; HOME.ok -> .done
  hierarchy WORK
    outcome ok
    POLICY
    start -> DRIVE ; DRIVE.ok -> .ok ; DRIVE.preempted -> STOW ; STOW.ok -> .ok ; STOW.aborted -> .aborted
    execution DRIVE
      outcome ok
    execution STOW
      outcome ok
  execution HOME
    outcome ok
";

#[test]
fn a_handler_in_what_recovers_runs() {
    check(
        &work(r#"{"recover_s": 0.05}"#),
        "start; silence 50; DRIVE preempted; STOW ok; HOME ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 50
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
            > HOME ok
            leave ROOT/HOME ok
            leave ROOT done
            finished
              end of run: done (0), 5 states
        "]],
    );
}

#[test]
fn a_state_that_was_preempted_by_its_policy_has_not_finished() {
    check(
        &work(r#"{"finish_s": 0.04, "hold_s": 0.08, "recover_s": 0.14}"#),
        "start; silence 80; silence 140; DRIVE preempted; STOW ok; HOME ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 80
            > silence 140
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
            > HOME ok
            leave ROOT/HOME ok
            leave ROOT done
            finished
              end of run: done (0), 5 states
        "]],
    );
}

#[test]
fn a_recovery_that_fails_is_not_held() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> WORK ; WORK.aborted -> HOME ; HOME.ok -> .done
  execution WORK
    outcome ok
    semantic {\"lost_link\": {\"finish_s\": 0.04, \"recover_s\": 0.14}}
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 140; WORK raises \"stuck\"; HOME ok",
        &expect![[r#"
        > start
        enter ROOT
        enter ROOT/WORK
          run ROOT/WORK
        > silence 140
        lost_link preempts ROOT/WORK
          preempt ROOT/WORK
        > WORK raises "stuck"
        leave ROOT/WORK aborted error="stuck"
        enter ROOT/HOME
          run ROOT/HOME error="stuck"
        > HOME ok
        leave ROOT/HOME ok
        leave ROOT done
        finished
          end of run: done (0), 3 states
    "#]],
    );
}

#[test]
fn handlers_in_a_root_that_recovers_run() {
    let machine = "
hierarchy ROOT
  outcome done
  semantic {\"lost_link\": {\"finish_s\": 0.04, \"hold_s\": 0.08, \"recover_s\": 0.14}}
  start -> DRIVE ; DRIVE.preempted -> STOW ; STOW.ok -> HOME ; HOME.ok -> .done
  execution DRIVE
    outcome ok
  hierarchy STOW
    outcome ok
    start -> FOLD ; FOLD.ok -> LOCK ; LOCK.ok -> .ok
    execution FOLD
      outcome ok
    execution LOCK
      outcome ok
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 140; DRIVE preempted; FOLD ok; LOCK ok; active",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 140
        lost_link preempts ROOT
          preempt ROOT
          preempt ROOT/DRIVE
        > DRIVE preempted
        leave ROOT/DRIVE preempted
        enter ROOT/STOW
        enter ROOT/STOW/FOLD
          run ROOT/STOW/FOLD
        > FOLD ok
        leave ROOT/STOW/FOLD ok
        enter ROOT/STOW/LOCK
          run ROOT/STOW/LOCK
        > LOCK ok
        leave ROOT/STOW/LOCK ok
        leave ROOT/STOW ok
        leave ROOT preempted
        finished
          end of run: preempted (-2), 5 states
        > active
        Finished, 5 states run
    "]],
    );
}

#[test]
fn a_recovery_that_is_resumed_is_not_held() {
    check(
        &work(r#"{"finish_s": 0.04, "hold_s": 0.08, "recover_s": 0.14}"#),
        "start; silence 140; cut again; DRIVE preempted; cut again; STOW ok; cut again; HOME ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 140
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > cut again
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE preempted
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > cut again
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
            > cut again
            enter ROOT
            enter ROOT/HOME
              run ROOT/HOME
            > HOME ok
            leave ROOT/HOME ok
            leave ROOT done
            finished
              end of run: done (0), 5 states
        "]],
    );
}

#[test]
fn a_recovery_that_is_resumed_between_two_states_is_not_held() {
    check(
        &work(r#"{"finish_s": 0.04, "hold_s": 0.08, "recover_s": 0.14}"#),
        "break 1 before ROOT/WORK/STOW; start; silence 140; DRIVE preempted; cut again;
         break 1 before ROOT/HOME; STOW ok; cut again",
        &expect![[r"
            > break 1 before ROOT/WORK/STOW
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 140
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            hit 1 at ROOT/WORK/STOW for the 1. time
            hold ROOT/WORK before ROOT/WORK/STOW (Breakpoint(1))
            > cut again
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > break 1 before ROOT/HOME
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            hit 1 at ROOT/HOME for the 1. time
            hold ROOT before ROOT/HOME (Breakpoint(1))
            > cut again
            enter ROOT
            enter ROOT/HOME
              run ROOT/HOME
        "]],
    );
}

#[test]
fn a_recovery_goes_on_when_the_ground_is_heard_again() {
    check(
        &work(r#"{"finish_s": 0.04, "recover_s": 0.14}"#),
        "start; silence 139; silence 0; silence 140; silence 0; DRIVE preempted; silence 4; STOW ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 139
            > silence 0
            > silence 140
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > silence 0
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > silence 4
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
        "]],
    );
}

#[test]
fn a_second_silence_is_counted_anew() {
    check(
        &work(r#"{"finish_s": 0.04, "recover_s": 0.14}"#),
        "start; silence 140; silence 0; silence 40; DRIVE preempted; STOW ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 140
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > silence 0
            > silence 40
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            hold ROOT before ROOT/HOME (Loss(Link))
        "]],
    );
}

#[test]
fn a_state_that_ends_by_itself_before_its_recovery_is_paused() {
    check(
        &work(r#"{"finish_s": 0.04, "recover_s": 0.14}"#),
        "start; silence 40; DRIVE ok; silence 140",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 40
            > DRIVE ok
            leave ROOT/WORK/DRIVE ok
            leave ROOT/WORK ok
            hold ROOT (Loss(Link))
            > silence 140
        "]],
    );
}

#[test]
fn the_way_home_goes_by_the_policy_around_it() {
    let machine = work(r#"{"recover_s": 0.05}"#);
    let hold = "  semantic {\"lost_link\": {\"hold_s\": 0.03}}\n  start -> WORK";
    let machine = machine.replace("  start -> WORK", hold);
    check(
        &machine,
        "start; silence 50; DRIVE preempted; STOW ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/WORK
        enter ROOT/WORK/DRIVE
          run ROOT/WORK/DRIVE
        > silence 50
        lost_link preempts ROOT/WORK
          preempt ROOT/WORK
          preempt ROOT/WORK/DRIVE
        > DRIVE preempted
        leave ROOT/WORK/DRIVE preempted
        enter ROOT/WORK/STOW
          run ROOT/WORK/STOW
        > STOW ok
        leave ROOT/WORK/STOW ok
        leave ROOT/WORK preempted
        hold ROOT before ROOT/HOME (Loss(Link))
    "]],
    );
    let home = "execution HOME\n    semantic {\"lost_link\": \"continue\"}";
    let machine = machine.replace("execution HOME", home);
    check(
        &machine,
        "start; silence 50; DRIVE preempted; STOW ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/WORK
        enter ROOT/WORK/DRIVE
          run ROOT/WORK/DRIVE
        > silence 50
        lost_link preempts ROOT/WORK
          preempt ROOT/WORK
          preempt ROOT/WORK/DRIVE
        > DRIVE preempted
        leave ROOT/WORK/DRIVE preempted
        enter ROOT/WORK/STOW
          run ROOT/WORK/STOW
        > STOW ok
        leave ROOT/WORK/STOW ok
        leave ROOT/WORK preempted
        enter ROOT/HOME
          run ROOT/HOME
    "]],
    );
}

#[test]
fn a_pause_inside_keeps_a_state_from_recovering() {
    let machine = work(r#"{"recover_s": 0.05}"#);
    let inner = "hierarchy DRIVE
      outcome ok
      semantic {\"lost_link\": {\"hold_s\": 0.03}}
      start -> GO ; GO.ok -> TURN ; TURN.ok -> .ok
      execution GO
        outcome ok
      execution TURN
        outcome ok";
    let machine = machine.replace("execution DRIVE\n      outcome ok", inner);
    check(
        &machine,
        "start; silence 30; GO ok; silence 50",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/WORK
        enter ROOT/WORK/DRIVE
        enter ROOT/WORK/DRIVE/GO
          run ROOT/WORK/DRIVE/GO
        > silence 30
        > GO ok
        leave ROOT/WORK/DRIVE/GO ok
        hold ROOT/WORK/DRIVE before ROOT/WORK/DRIVE/TURN (Loss(Link))
        > silence 50
    "]],
    );
}

#[test]
fn a_recovery_around_preempts_the_way_home() {
    let machine = work(r#"{"recover_s": 0.05}"#);
    let policy = "  semantic {\"lost_link\": {\"recover_s\": 0.09}}\n  start -> WORK";
    let machine = machine.replace("  start -> WORK", policy);
    check(
        &machine,
        "start; silence 50; DRIVE preempted; STOW ok; silence 90; HOME preempted",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 50
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
            > silence 90
            lost_link preempts ROOT
              preempt ROOT
              preempt ROOT/HOME
            > HOME preempted
            leave ROOT/HOME preempted
            leave ROOT preempted
            finished
              end of run: preempted (-2), 5 states
        "]],
    );
}

#[test]
fn a_branch_of_a_barrier_recovers_by_itself() {
    let policy =
        "hierarchy ARM\n      semantic {\"lost_link\": {\"finish_s\": 0.01, \"recover_s\": 0.03}}";
    let machine = RECOVER.replace("{\"recover_s\": 0.03}", "\"continue\"");
    let machine = machine.replace("hierarchy ARM", policy).replace("A.ok -> B", "A.preempted -> B");
    let machine = machine.replacen("        semantic {\"lost_link\": \"continue\"}\n", "", 1);
    check(
        &machine,
        "start; silence 30; A preempted; B ok; C ok; D ok; unique_decider_state_id ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/DRIVE
            enter ROOT/DRIVE/ARM
            enter ROOT/DRIVE/ARM/A
            enter ROOT/DRIVE/WHEELS
            enter ROOT/DRIVE/WHEELS/C
              fork 1
              run ROOT/DRIVE/ARM/A on 1
              fork 2
              run ROOT/DRIVE/WHEELS/C on 2
            > silence 30
            lost_link preempts ROOT/DRIVE/ARM
              preempt ROOT/DRIVE/ARM
              preempt ROOT/DRIVE/ARM/A
            > A preempted
            leave ROOT/DRIVE/ARM/A preempted
            enter ROOT/DRIVE/ARM/B
              run ROOT/DRIVE/ARM/B on 1
            > B ok
            leave ROOT/DRIVE/ARM/B ok
            leave ROOT/DRIVE/ARM preempted
              end 1
            > C ok
            leave ROOT/DRIVE/WHEELS/C ok
            enter ROOT/DRIVE/WHEELS/D
              run ROOT/DRIVE/WHEELS/D on 2
            > D ok
            leave ROOT/DRIVE/WHEELS/D ok
            leave ROOT/DRIVE/WHEELS ok
            enter ROOT/DRIVE/unique_decider_state_id
              end 2
              run ROOT/DRIVE/unique_decider_state_id [ARM preempted] [WHEELS ok]
            > unique_decider_state_id ok
            leave ROOT/DRIVE/unique_decider_state_id ok
            leave ROOT/DRIVE ok
            leave ROOT done
            finished
              end of run: done (0), 9 states
        "]],
    );
}

#[test]
fn a_branch_that_recovers_wins_its_race() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> RACE ; RACE.ok -> .done ; RACE.lost -> HOME ; HOME.ok -> .done
  preemptive RACE
    outcome ok
    outcome lost
    DRIVE.ok -> .ok ; DRIVE.preempted -> .lost ; WATCH.ok -> .ok
    execution DRIVE
      outcome ok
      semantic {\"lost_link\": {\"finish_s\": 0.01, \"recover_s\": 0.03}}
    execution WATCH
      outcome ok
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 30; DRIVE preempted; WATCH ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/RACE
        enter ROOT/RACE/DRIVE
        enter ROOT/RACE/WATCH
          fork 1
          run ROOT/RACE/DRIVE on 1
          fork 2
          run ROOT/RACE/WATCH on 2
        > silence 30
        lost_link preempts ROOT/RACE/DRIVE
          preempt ROOT/RACE/DRIVE
        > DRIVE preempted
        leave ROOT/RACE/DRIVE preempted
          end 1
          preempt ROOT/RACE/WATCH
        > WATCH ok
        leave ROOT/RACE/WATCH preempted
        leave ROOT/RACE lost
        enter ROOT/HOME
          end 2
          run ROOT/HOME
    "]],
    );
}

#[test]
fn a_root_that_is_to_finish_pauses_nothing() {
    let machine = DRIVE.replace("hold_s", "finish_s");
    check(
        &machine,
        "start; silence 60; DRIVE ok; A ok; B ok",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/DRIVE
          run ROOT/DRIVE
        > silence 60
        > DRIVE ok
        leave ROOT/DRIVE ok
        enter ROOT/SAMPLE
        enter ROOT/SAMPLE/A
          run ROOT/SAMPLE/A
        > A ok
        leave ROOT/SAMPLE/A ok
        enter ROOT/SAMPLE/B
          run ROOT/SAMPLE/B
        > B ok
        leave ROOT/SAMPLE/B ok
        leave ROOT/SAMPLE ok
        leave ROOT done
        finished
          end of run: done (0), 5 states
    "]],
    );
}

#[test]
fn what_a_policy_holds_goes_on_once_it_is_preempted() {
    check(
        &work(r#"{"hold_s": 0.03}"#).replace("DRIVE.ok -> .ok", "DRIVE.ok -> STOW"),
        "start; silence 30; DRIVE ok; preempt ROOT/WORK; HOME ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 30
            > DRIVE ok
            leave ROOT/WORK/DRIVE ok
            hold ROOT/WORK before ROOT/WORK/STOW (Loss(Link))
            > preempt ROOT/WORK
            leave ROOT/WORK preempted
            enter ROOT/HOME
              preempt ROOT/WORK
              run ROOT/HOME
            > HOME ok
            leave ROOT/HOME ok
            leave ROOT done
            finished
              end of run: done (0), 4 states
        "]],
    );
}

#[test]
fn the_state_around_recovers_behind_what_was_paused() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> MISSION ; MISSION.preempted -> HOME ; MISSION.ok -> .done ; HOME.ok -> .done
  hierarchy MISSION
    outcome ok
    semantic {\"lost_link\": {\"recover_s\": 0.14}}
    start -> WORK ; WORK.ok -> .ok
    execution WORK
      outcome ok
      semantic {\"lost_link\": {\"finish_s\": 0.04, \"recover_s\": 0.14}}
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 40; WORK ok; silence 140",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/MISSION
        enter ROOT/MISSION/WORK
          run ROOT/MISSION/WORK
        > silence 40
        > WORK ok
        leave ROOT/MISSION/WORK ok
        hold ROOT/MISSION (Loss(Link))
        > silence 140
        lost_link preempts ROOT/MISSION
        leave ROOT/MISSION preempted
        enter ROOT/HOME
          preempt ROOT/MISSION
          run ROOT/HOME
    "]],
    );
    check(
        machine,
        "start; silence 40; silence 140; WORK preempted",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/MISSION
        enter ROOT/MISSION/WORK
          run ROOT/MISSION/WORK
        > silence 40
        > silence 140
        lost_link preempts ROOT/MISSION/WORK
          preempt ROOT/MISSION/WORK
        > WORK preempted
        leave ROOT/MISSION/WORK preempted
        leave ROOT/MISSION preempted
        enter ROOT/HOME
          run ROOT/HOME
    "]],
    );
}

#[test]
fn the_way_home_continues_when_the_ground_is_heard_again() {
    check(
        &work(r#"{"recover_s": 0.05}"#).replace("HOME.ok -> .done", "HOME.ok -> WORK"),
        "start; silence 50; DRIVE preempted; STOW ok; silence 0; HOME ok",
        &expect![[r"
            > start
            enter ROOT
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
            > silence 50
            lost_link preempts ROOT/WORK
              preempt ROOT/WORK
              preempt ROOT/WORK/DRIVE
            > DRIVE preempted
            leave ROOT/WORK/DRIVE preempted
            enter ROOT/WORK/STOW
              run ROOT/WORK/STOW
            > STOW ok
            leave ROOT/WORK/STOW ok
            leave ROOT/WORK preempted
            enter ROOT/HOME
              run ROOT/HOME
            > silence 0
            > HOME ok
            leave ROOT/HOME ok
            enter ROOT/WORK
            enter ROOT/WORK/DRIVE
              run ROOT/WORK/DRIVE
        "]],
    );
}

#[test]
fn the_root_of_a_library_recovers() {
    let machine = "
hierarchy ROOT
  outcome done
  start -> LIB ; LIB.preempted -> HOME ; LIB.ok -> .done ; HOME.ok -> .done
  library LIB from \"some/library\"
    content
      execution WORK
        outcome ok
        semantic {\"lost_link\": {\"finish_s\": 0.04, \"recover_s\": 0.14}}
  execution HOME
    outcome ok
";
    check(
        machine,
        "start; silence 140; WORK preempted",
        &expect![[r"
        > start
        enter ROOT
        enter ROOT/LIB
        enter ROOT/LIB/WORK
          run ROOT/LIB/WORK
        > silence 140
        lost_link preempts ROOT/LIB/WORK
          preempt ROOT/LIB/WORK
        > WORK preempted
        leave ROOT/LIB/WORK preempted
        leave ROOT/LIB preempted
        enter ROOT/HOME
          run ROOT/HOME
    "]],
    );
}
