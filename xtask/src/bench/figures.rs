//! The figures with bars, in the order of the output.

/// Bar of a figure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bar {
    /// Minimum; higher is better.
    AtLeast(f64),
    /// Maximum; lower is better.
    AtMost(f64),
}

/// A figure with a bar.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Figure {
    /// Name in the JSON lines.
    pub(crate) name: &'static str,
    /// Unit in the JSON lines.
    pub(crate) unit: &'static str,
    /// The bar.
    pub(crate) bar: Bar,
    /// Description for people.
    pub(crate) meaning: &'static str,
}

const fn least(name: &'static str, unit: &'static str, bar: f64, meaning: &'static str) -> Figure {
    Figure { name, unit, bar: Bar::AtLeast(bar), meaning }
}

const fn most(name: &'static str, unit: &'static str, bar: f64, meaning: &'static str) -> Figure {
    Figure { name, unit, bar: Bar::AtMost(bar), meaning }
}

/// All figures with bars.
pub(crate) const ALL: [Figure; 27] = [
    least(
        "python_flat_states_per_s",
        "states/s",
        200_000.0,
        "two Python states in a loop with an int counter",
    ),
    least(
        "python_flat_over_reference",
        "ratio",
        200.0,
        "the same, against the reference in this run",
    ),
    // The engine executes 1.7 instructions for each instruction of the loop (measured with callgrind). The rest is one
    // system call per state, which attributes the output of child processes and native code to it. A bar of 0.5 would
    // require its removal.
    least("python_flat_over_call_loop", "ratio", 0.4, "the same, against a bare CPython call loop"),
    // A profile shows no function above 9 %. The first writes to the memory of the events and its release take 25 % of the
    // time, as for copies; the rest is spread over the whole engine.
    least(
        "native_flat_over_copies",
        "ratio",
        0.18,
        "the same loop with native states, against copies of its events",
    ),
    most("load_750_ms", "ms", 50.0, "load a machine of 750 states"),
    most("load_10000_ms", "ms", 500.0, "load a machine of 10,000 states"),
    most("save_10000_ms", "ms", 3_000.0, "save all of its states"),
    most("save_one_edit_ms", "ms", 10.0, "save it after one edit"),
    most("memory_10000_mb", "MB", 40.0, "memory that it takes when loaded"),
    most("build_10000_ms", "ms", 200.0, "build it by edits with full checks"),
    most("preempt_ms", "ms", 1.0, "winner's end to the preemptive state's end"),
    most(
        "first_state_ms",
        "ms",
        100.0,
        "process start to first state, above the interpreter's own start",
    ),
    most("barrier_64_ms", "ms", 3.0, "barrier of 64 children that do nothing, once"),
    least(
        "journal_full_states_per_s",
        "states/s",
        100_000.0,
        "the Python states with everything kept in the journal",
    ),
    least("journal_over_off", "ratio", 0.7, "the same, against a run that is not kept"),
    least(
        "no_link_cost_ratio",
        "ratio",
        0.95,
        "the same on a robot that sends it to a station, against one that does not",
    ),
    most(
        "journal_bytes_per_state",
        "bytes",
        64.0,
        "size of a run's folder for each executed state, without data",
    ),
    most("open_1m_page_ms", "ms", 100.0, "open a run of 1,000,000 events and read its first page"),
    most("open_1m_moment_ms", "ms", 200.0, "open it and see how it stood at any of them"),
    most("command_ms", "ms", 2.0, "a command from the socket to the script that it preempts"),
    most(
        "server_command_ms",
        "ms",
        3.0,
        "the same from a client of the server, over HTTP or WebSocket, whichever takes longer",
    ),
    most("server_status_ms", "ms", 15.0, "a state's change to the status that a client is told"),
    // Checks, the JSON document and the client's parser take as long as the load.
    most(
        "server_open_10000_over_load",
        "ratio",
        2.2,
        "a client opens a machine of 10,000 states, against loading it in one program",
    ),
    most("server_edit_10000_ms", "ms", 5.0, "an edit in it, to the answer"),
    most(
        "server_followers_p99_ratio",
        "ratio",
        1.1,
        "slowest 1 % of states' ends at 1,000 states/s, 50 clients following over none",
    ),
    // The load of the machine and the start of the interpreter take half of it, and have bars of their own. A computer that
    // loads in 175 ms needs 485 to 556 ms.
    most(
        "resume_10000_ms",
        "ms",
        500.0,
        "the death of a runner to the next script, in a machine of 10,000 states with 24 active branches",
    ),
    most(
        "server_idle_cpu_percent",
        "%",
        0.05,
        "CPU of a server with 5 clients and a run that waits",
    ),
];

impl Bar {
    /// True if the value meets the bar.
    pub(crate) fn is_kept(self, value: f64) -> bool {
        match self {
            Self::AtLeast(bar) => value >= bar,
            Self::AtMost(bar) => value <= bar,
        }
    }
}

/// The median; `None` without values.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) =
        (values.get(values.len().checked_sub(1)? / 2)?, values.get(values.len() / 2)?);
    Some(f64::midpoint(*low, *high))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle() {
        assert_eq!(median(vec![]), None);
        assert_eq!(median(vec![3.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), Some(2.5));
    }

    #[test]
    fn a_promise_has_a_direction() {
        assert!(Bar::AtLeast(2.0).is_kept(2.0) && !Bar::AtLeast(2.0).is_kept(1.9));
        assert!(Bar::AtMost(2.0).is_kept(2.0) && !Bar::AtMost(2.0).is_kept(2.1));
    }
}
