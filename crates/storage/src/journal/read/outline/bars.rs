//! Calls for a drawing of a given width. Narrow calls are merged, so that the size of the result depends on the width and not on
//! the number of events. Handles times and pixels.

use super::blocks::RowSum;
use super::calls::{BarRow, Call};
use crate::journal::record::{PlaceNumber, Places};
use rafcon_protocol::api::{CallEnd, OverviewBar, OverviewRow};
use std::collections::BTreeMap;

/// Minimum width of a single call in pixels. Narrower calls are merged.
const NARROW: u64 = 2;

/// A part of a run's time, and the width of its drawing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Span {
    /// Start of the part, in ns since the start of the run.
    pub from_ns: u64,
    /// End of the part, in ns since the start of the run.
    pub to_ns: u64,
    /// Width of the drawing in pixels.
    pub pixels: u32,
}

impl Span {
    /// Returns the duration below which a call is too narrow to be drawn alone.
    fn narrow_ns(self) -> u64 {
        let length = self.to_ns.saturating_sub(self.from_ns);
        (length.saturating_mul(NARROW) / u64::from(self.pixels.max(1))).max(1)
    }

    /// Returns true if a call with these times is visible.
    pub(super) fn shows(self, from_ns: u64, to_ns: Option<u64>) -> bool {
        from_ns <= self.to_ns && to_ns.is_none_or(|to_ns| to_ns >= self.from_ns)
    }
}

/// Bars by row, in the order of their arrival.
#[derive(Debug)]
pub(super) struct Bars {
    span: Span,
    narrow_ns: u64,
    rows: BTreeMap<BarRow, Vec<Bar>>,
}

#[derive(Debug, Clone, Copy)]
struct Bar {
    from_ns: u64,
    to_ns: Option<u64>,
    many: u64,
    failed: u64,
    place: PlaceNumber,
    first: u64,
    end: CallEnd,
}

impl Bars {
    pub(super) fn new(span: Span) -> Self {
        Self { span, narrow_ns: span.narrow_ns(), rows: BTreeMap::new() }
    }

    pub(super) fn call(&mut self, call: Call) {
        let Call { place, row, first, from_ns, to_ns, end } = call;
        let failed = u64::from(end == CallEnd::Aborted);
        self.add(row, Bar { from_ns, to_ns, many: 1, failed, place, first, end });
    }

    pub(super) fn sum(&mut self, sum: &RowSum) {
        let RowSum { row, place, first, from_ns, to_ns, many, failed, end } = *sum;
        let bar = Bar { from_ns, to_ns: Some(to_ns), many, failed, place, first, end };
        self.add(row, bar);
    }

    fn add(&mut self, row: BarRow, bar: Bar) {
        if !self.span.shows(bar.from_ns, bar.to_ns) {
            return;
        }
        let bars = self.rows.entry(row).or_default();
        match bars.last_mut() {
            Some(last) if joins(last, &bar, self.narrow_ns) => last.join(&bar),
            _ => bars.push(bar),
        }
    }

    /// Returns the rows, and the paths of the places to which they refer.
    pub(super) fn finish(self, places: &Places) -> (Vec<OverviewRow>, Vec<String>) {
        let mut paths = Paths { places, numbers: BTreeMap::new(), known: Vec::new() };
        let narrow_ns = self.narrow_ns;
        let rows = self.rows.into_values().filter_map(|mut bars| {
            // A call whose length was unknown at its start comes last.
            bars.sort_by_key(|bar| (bar.from_ns, bar.first));
            bars.dedup_by(|bar, last| {
                let is_one = joins(last, bar, narrow_ns);
                if is_one {
                    last.join(bar);
                }
                is_one
            });
            let place = paths.number(bars.first()?.place);
            let bars = bars.iter().map(|bar| bar.spelled(paths.number(bar.place))).collect();
            Some(OverviewRow { place, bars })
        });
        let rows: Vec<OverviewRow> = rows.collect();
        (rows, paths.known)
    }
}

/// Returns true if two narrow bars start in one range of pixels.
fn joins(last: &Bar, bar: &Bar, narrow_ns: u64) -> bool {
    let is_narrow =
        |bar: &Bar| bar.to_ns.is_some_and(|to_ns| to_ns.saturating_sub(bar.from_ns) < narrow_ns);
    is_narrow(last) && is_narrow(bar) && last.from_ns / narrow_ns == bar.from_ns / narrow_ns
}

impl Bar {
    fn join(&mut self, later: &Self) {
        self.to_ns = self.to_ns.max(later.to_ns);
        self.many += later.many;
        self.failed += later.failed;
    }

    fn spelled(&self, place: u32) -> OverviewBar {
        let Self { from_ns, to_ns, many, failed, first: sequence, end, .. } = *self;
        OverviewBar { from_ns, to_ns, many, failed, place, sequence, end }
    }
}

/// Paths by their index in the result.
struct Paths<'p> {
    places: &'p Places,
    numbers: BTreeMap<PlaceNumber, u32>,
    known: Vec<String>,
}

impl Paths<'_> {
    fn number(&mut self, place: PlaceNumber) -> u32 {
        *self.numbers.entry(place).or_insert_with(|| {
            self.known.push(self.places.path(place).to_owned());
            u32::try_from(self.known.len() - 1).unwrap_or(u32::MAX)
        })
    }
}
