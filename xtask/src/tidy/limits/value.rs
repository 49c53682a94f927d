//! Values of bounds in sources and in the list.

/// A number, a time in milliseconds, or a text without further interpretation.
#[derive(Debug, PartialEq)]
pub(super) enum Value {
    Number(f64),
    Milliseconds(f64),
    Other(String),
}

impl Value {
    /// The value of an expression in Rust, TypeScript or Python.
    pub(super) fn of_source(expression: &str) -> Self {
        let scaled = |scale: f64, inner: &str| number(inner).map(|n| Self::Milliseconds(scale * n));
        let duration = expression.strip_suffix(')').and_then(|call| {
            let (unit, inner) = call.strip_prefix("Duration::from_")?.split_once('(')?;
            match unit {
                "millis" => scaled(1.0, inner),
                "secs" => scaled(1e3, inner),
                "mins" => scaled(60e3, inner),
                "hours" => scaled(3_600e3, inner),
                _ => None,
            }
        });
        let other = || Self::Other(plain(expression));
        duration.or_else(|| number(expression).map(Self::Number)).unwrap_or_else(other)
    }

    /// The value of a cell, such as `4,096`, `16 MiB`, `10 s`; any other text in backticks.
    pub(super) fn of_document(cell: &str) -> Self {
        let (figure, unit) = cell.split_once(' ').unwrap_or((cell, ""));
        let Ok(figure) = figure.replace(',', "").parse::<f64>() else {
            return Self::Other(plain(cell.trim_matches('`')));
        };
        match unit {
            "" => Self::Number(figure),
            "KiB" => Self::Number(figure * 1024.0),
            "MiB" => Self::Number(figure * 1024.0 * 1024.0),
            "GiB" => Self::Number(figure * 1024.0 * 1024.0 * 1024.0),
            "ms" => Self::Milliseconds(figure),
            "s" => Self::Milliseconds(figure * 1e3),
            "min" => Self::Milliseconds(figure * 60e3),
            "h" => Self::Milliseconds(figure * 3_600e3),
            _ => Self::Other(plain(cell)),
        }
    }
}

/// A text without differences in formatting.
fn plain(text: &str) -> String {
    text.chars().filter(|c| !c.is_whitespace()).collect()
}

/// Sums of products and shifts of numbers; `None` for anything else.
fn number(expression: &str) -> Option<f64> {
    let expression = expression.trim();
    if let Some((left, right)) = expression.rsplit_once(" - ") {
        return Some(number(left.trim_start_matches('('))? - number(right)?);
    }
    if let Some((left, right)) = expression.split_once(" + ") {
        return Some(number(left)? + number(right)?);
    }
    if let Some((left, right)) = expression.split_once(" * ") {
        return Some(number(left)? * number(right)?);
    }
    if let Some((left, right)) = expression.split_once(" << ") {
        return Some(number(left)? * 2_f64.powf(number(right)?));
    }
    let digits = expression.trim_matches(['(', ')']).replace('_', "");
    digits.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(source: &str, cell: &str) {
        assert_eq!(Value::of_source(source), Value::of_document(cell), "{source}");
    }

    #[test]
    fn sources_and_cells_have_one_value() {
        check("4_096", "4,096");
        check("16 << 20", "16 MiB");
        check("64 * 1024", "64 KiB");
        check("365.0 * 86_400.0", "31,536,000");
        check("1 + 5 + 10", "16");
        check("(1 << 48) - 1", "281474976710655");
        check("Duration::from_mins(1)", "60 s");
        check("Duration::from_millis(250)", "250 ms");
        check("TreeLimits { nodes: 10_000 }", "`TreeLimits { nodes: 10_000 }`");
        assert_ne!(Value::of_source("1"), Value::of_document("2"));
        assert_ne!(Value::of_source("1000"), Value::of_document("1 s"));
    }
}
