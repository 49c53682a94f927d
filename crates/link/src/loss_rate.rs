//! Measured share of datagrams that are lost, and how often data is sent so that nearly all of it arrives without a request.

use std::ops::RangeInclusive;

/// Number of sends, from that of a link without losses to that of a link that loses most datagrams.
const SENDS: RangeInclusive<u8> = 2..=5;
/// Acceptable loss after all sends, per mille.
const ACCEPTED_PER_MILLE: u128 = 5;
/// Weight of earlier reports, in sixteenths.
const EARLIER: u64 = 15;

/// Sent and arrived bytes of the last reports. Earlier reports count less and less.
#[derive(Debug, Default)]
pub(crate) struct LossRate {
    sent: u64,
    arrived: u64,
}

impl LossRate {
    /// Counts the bytes sent between two reports, and those of them that arrived.
    pub(crate) fn add(&mut self, sent: u64, arrived: u64) {
        let earlier = |bytes: u64| bytes / 16 * EARLIER + bytes % 16 * EARLIER / 16;
        self.sent = earlier(self.sent).saturating_add(sent);
        self.arrived = earlier(self.arrived).saturating_add(arrived);
    }

    /// Number of sends after which at most one in 200 datagrams is lost.
    pub(crate) fn sends(&self) -> u8 {
        let lost = u128::from(self.sent.saturating_sub(self.arrived));
        let lost_per_mille = lost * 1_000 / u128::from(self.sent.max(1));
        let (mut sends, mut left) = (1, lost_per_mille);
        while sends < *SENDS.end() && left > ACCEPTED_PER_MILLE {
            left = left * lost_per_mille / 1_000;
            sends += 1;
        }
        sends.max(*SENDS.start())
    }
}

#[cfg(test)]
mod tests {
    use super::LossRate;
    use proptest::prelude::*;

    fn sends(lost_percent: u64) -> u8 {
        let mut rate = LossRate::default();
        for _ in 0..20 {
            rate.add(10_000, 10_000 - lost_percent * 100);
        }
        rate.sends()
    }

    #[test]
    fn data_is_sent_as_often_as_the_losses_need() {
        assert_eq!(LossRate::default().sends(), 2);
        assert_eq!([0, 2, 7, 8, 17, 19, 30, 90].map(sends), [2, 2, 2, 3, 3, 4, 5, 5]);
    }

    #[test]
    fn a_link_that_loses_less_than_before_needs_fewer_sends() {
        let mut rate = LossRate::default();
        rate.add(100_000, 20_000);
        assert_eq!(rate.sends(), 5);
        for _ in 0..90 {
            rate.add(10_000, 10_000);
        }
        assert_eq!(rate.sends(), 2);
    }

    proptest! {
        #[test]
        fn any_reports_give_a_number_of_sends(
            reports in prop::collection::vec(any::<(u64, u64)>(), 0..20),
        ) {
            let mut rate = LossRate::default();
            for (sent, arrived) in reports {
                rate.add(sent, arrived);
                prop_assert!((2..=5).contains(&rate.sends()));
            }
        }
    }
}
