//! What scripts were running when a runner died: two small files in the run's folder, written as the run goes.
//!
//! [`SLOTS_FILE`] holds one little-endian `u32` for each thread of the runner: 0, or the number of a line of
//! [`PATHS_FILE`], counted from 1. Each line is the path of a state. The files outlive any death of the process, and are
//! true at that moment: a script is marked before it begins.

/// Name of the file with one number for each thread.
pub const SLOTS_FILE: &str = "active";
/// Name of the file with one path on each line.
pub const PATHS_FILE: &str = "paths";
/// How many threads have a number; scripts on further threads are not marked.
pub const SLOTS: usize = 4096;

/// The paths of the states whose scripts run, each once, in the order of the alphabet. Never fails: what is cut off or wrong
/// is left out.
pub fn running(slots: &[u8], paths: &str) -> Vec<String> {
    let lines: Vec<&str> = paths.lines().collect();
    let numbers = slots
        .chunks_exact(4)
        .map(|bytes| u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]));
    let line = |number: u32| lines.get((number as usize).checked_sub(1)?).copied();
    let mut found: Vec<String> = numbers.filter_map(line).map(str::to_owned).collect();
    found.sort();
    found.dedup();
    found
}

#[cfg(test)]
mod tests {
    use super::running;

    #[test]
    fn numbers_without_a_line_are_left_out() {
        let slots: Vec<u8> =
            [2_u32, 0, 9, 1, 2].iter().flat_map(|n| n.to_le_bytes()).chain([1]).collect();
        assert_eq!(running(&slots, "A/B\nA/C\n"), ["A/B", "A/C"]);
    }
}
