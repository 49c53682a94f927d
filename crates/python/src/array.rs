//! Evenly spaced samples of an array, for views.
//!
//! Knows the common interface of arrays from any library: `shape`, `dtype.kind`, slices and `tolist`. Must never import one
//! of these libraries, nor copy a whole array.

use pyo3::prelude::*;
use pyo3::types::{PyList, PySlice, PyTuple};

/// Kinds of numeric and boolean types, as in `dtype.kind`.
const KINDS: &str = "biuf";

/// Items sampled from an array.
#[derive(Debug)]
pub(crate) struct Sample<'py> {
    /// The sampled items in row-major order.
    pub(crate) items: Vec<Bound<'py, PyAny>>,
    /// Number of sampled items along each axis.
    pub(crate) sampled: Vec<u64>,
    /// Distance between sampled items along each axis.
    pub(crate) steps: Vec<u64>,
}

/// Samples at most `count_max` items of an array of this shape. `None` if the items are not numbers or cannot be read.
pub(crate) fn sample<'py>(
    object: &Bound<'py, PyAny>,
    shape: &[u64],
    count_max: usize,
) -> Option<Sample<'py>> {
    let kind = object.getattr("dtype").ok()?.getattr("kind").ok()?;
    let kind = kind.extract::<String>().ok()?;
    if kind.len() != 1 || !KINDS.contains(&kind) || count_max == 0 {
        return None;
    }
    let steps = steps(shape, count_max as u64);
    let sampled: Vec<u64> =
        shape.iter().zip(&steps).map(|(size, step)| size.div_ceil(*step)).collect();
    let count = usize::try_from(sampled.iter().product::<u64>()).ok()?;
    let mut items = Vec::with_capacity(count);
    if count > 0 {
        let part = object.get_item(slices(object.py(), &steps)?).ok()?;
        flatten(part.call_method0("tolist").ok()?, &sampled, &mut items)?;
    }
    (items.len() == count).then_some(Sample { items, sampled, steps })
}

/// Distance between samples along each axis. Short axes are sampled fully; long ones share the largest cap that fits
/// `count_max`.
fn steps(shape: &[u64], count_max: u64) -> Vec<u64> {
    let fits = |cap: u64| {
        let counts = shape.iter().map(|size| (*size).min(cap));
        counts.into_iter().try_fold(1_u64, u64::checked_mul).is_some_and(|all| all <= count_max)
    };
    let cap = (1..=count_max).rev().find(|cap| fits(*cap)).unwrap_or(1);
    shape.iter().map(|size| size.div_ceil((*size).min(cap).max(1)).max(1)).collect()
}

fn slices<'py>(py: Python<'py>, steps: &[u64]) -> Option<Bound<'py, PyTuple>> {
    let slices = steps.iter().map(|step| {
        let step = isize::try_from(*step).ok()?;
        Some(PySlice::new(py, 0, isize::MAX, step))
    });
    PyTuple::new(py, slices.collect::<Option<Vec<_>>>()?).ok()
}

/// The numbers of nested lists; `None` unless their lengths match.
fn flatten<'py>(
    nested: Bound<'py, PyAny>,
    sampled: &[u64],
    items: &mut Vec<Bound<'py, PyAny>>,
) -> Option<()> {
    let Some((count, inner)) = sampled.split_first() else {
        items.push(nested);
        return Some(());
    };
    let list = nested.cast_into::<PyList>().ok()?;
    if list.len() as u64 != *count {
        return None;
    }
    list.iter().try_for_each(|item| flatten(item, inner, items))
}
