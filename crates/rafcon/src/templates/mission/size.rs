//! Sizes of the parts of a mission, for the requested number of states. Knows numbers only.

use super::{count, int, waypoint};
use anyhow::{Result, bail};
use rafcon_model::Value;

/// Numbers of the repeated parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Size {
    /// Sectors of the ground.
    pub(super) sectors: usize,
    /// Waypoints in all sectors together.
    pub(super) waypoints: usize,
    /// Devices that are checked before the start.
    pub(super) checks: usize,
}

/// States of a sector besides its waypoints: the sector, the visit, the watch over the battery.
const SECTOR: usize = 3;

impl Size {
    /// The smallest mission: one object to fetch at each of two waypoints.
    pub(super) const SMALLEST: Self = Self { sectors: 1, waypoints: 2, checks: 4 };

    /// The size of a mission of exactly `states` states, if the smallest has `smallest`.
    pub(super) fn fit(states: usize, smallest: usize) -> Result<Self> {
        let waypoint = count(&waypoint::waypoint(1));
        let Some(spare) = states.checked_sub(smallest) else {
            bail!("a mission has at least {smallest} states: give a larger number with `--states`");
        };
        // The number of sectors is close to the number of waypoints in a sector.
        let sectors = (spare / waypoint).isqrt().clamp(1, spare / SECTOR + 1);
        let spare = spare - (sectors - 1) * SECTOR;
        let waypoints = Self::SMALLEST.waypoints + spare / waypoint;
        Ok(Self { sectors, waypoints, checks: Self::SMALLEST.checks + spare % waypoint })
    }

    /// Number of waypoints in each sector. The first sectors have one more if the division has a remainder.
    pub(super) fn sectors(self) -> Vec<usize> {
        let (each, more) = (self.waypoints / self.sectors, self.waypoints % self.sectors);
        (0..self.sectors).map(|sector| each + usize::from(sector < more)).collect()
    }

    /// The numbers of waypoints as a value for a script.
    pub(super) fn sectors_value(self) -> Value {
        Value::List(self.sectors().into_iter().map(int).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::Size;

    #[test]
    fn sectors_hold_all_waypoints_and_differ_by_one_at_most() {
        let size = Size { sectors: 4, waypoints: 10, checks: 0 };
        assert_eq!(size.sectors(), [3, 3, 2, 2]);
    }
}
