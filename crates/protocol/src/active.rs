//! Record of the scripts that are running, for the case that the runner dies: two small files in the run's folder.
//!
//! [`SLOTS_FILE`] holds one little-endian `u32` for each thread of the runner: 0, or the number of a line of [`PATHS_FILE`],
//! counted from 1. Each line is the path of a state. The files survive the death of the process and are exact at that moment: a
//! script is marked before it begins.

/// Name of the file with one number for each thread.
pub const SLOTS_FILE: &str = "active";
/// Name of the file with one path on each line.
pub const PATHS_FILE: &str = "paths";
/// Number of threads with a slot. Scripts on further threads are not marked.
pub const SLOTS: usize = 4096;

/// Returns the paths of the states whose scripts run, sorted and without duplicates. Truncated or invalid entries are skipped.
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
