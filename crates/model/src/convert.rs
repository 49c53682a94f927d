//! Defaults and runtime values as files hold them, to the value of the declared type. Knows what Python's built-in types
//! make of a text; leaves other types to Python.

use crate::literal::{self, LiteralError, parse_float, parse_int};
use crate::{DataType, Value};
use smol_str::{SmolStr, format_smolstr};

/// The meaning of a value.
#[derive(Debug, Clone, PartialEq)]
pub enum Conversion {
    /// The value, converted to the type if it was a text.
    Value(Value),
    /// The value that the global variable of this name has when the state runs.
    Global(SmolStr),
    /// Only Python can make the value of this type.
    NeedsPython,
    /// The value does not fit the type; the reason for the user.
    Fails(SmolStr),
}

/// The meaning of a port's default (`docs/format.md`, defaults): the text `None` is `None` for every type, a text that
/// begins with `$` names a global variable, any other text is converted to the type.
///
/// ```
/// use rafcon_model::{Conversion, DataType, Value, convert};
///
/// let text = Value::str("[1, 2]");
/// let list = Value::List([Value::Int(1), Value::Int(2)].into());
/// assert_eq!(convert(&text, &DataType::List), Conversion::Value(list));
/// assert_eq!(convert(&text, &DataType::Str), Conversion::Value(text));
/// ```
pub fn convert(value: &Value, data_type: &DataType) -> Conversion {
    match value {
        Value::Str(text) if text.as_ref() == "None" => Conversion::Value(Value::None),
        _ => convert_runtime_value(value, data_type),
    }
}

/// The meaning of a runtime value of a library state, where the text `None` is a text like any other.
pub fn convert_runtime_value(value: &Value, data_type: &DataType) -> Conversion {
    match value {
        Value::Str(text) => match text.strip_prefix('$').filter(|name| !name.is_empty()) {
            Some(name) => Conversion::Global(name.into()),
            None => from_text(text, data_type),
        },
        _ => match fits(value, data_type) {
            Some(true) => Conversion::Value(value.clone()),
            Some(false) => fails(value, data_type),
            None => Conversion::NeedsPython,
        },
    }
}

/// True if a value other than a text has the type; `None` if only Python knows.
fn fits(value: &Value, data_type: &DataType) -> Option<bool> {
    let any = matches!(data_type, DataType::Object | DataType::None);
    match value {
        Value::None => Some(true),
        _ if any => Some(true),
        Value::Encoded(_) => None,
        Value::Bool(_) if *data_type == DataType::Int => Some(true),
        _ if DataType::of(value).as_ref() == Some(data_type) => Some(true),
        _ if matches!(data_type, DataType::Named(_)) => None,
        _ => Some(false),
    }
}

fn fails(value: &Value, data_type: &DataType) -> Conversion {
    let shown = literal::write(value).unwrap_or_else(|| "this value".to_owned());
    Conversion::Fails(format_smolstr!("{shown} is not of the type {data_type}"))
}

fn from_text(text: &str, data_type: &DataType) -> Conversion {
    let or_fail = |value: Option<Value>| {
        value.map_or_else(|| fails(&Value::str(text), data_type), Conversion::Value)
    };
    match data_type {
        DataType::Str | DataType::None => Conversion::Value(Value::str(text)),
        DataType::Int | DataType::Float if !text.is_ascii() => Conversion::NeedsPython,
        DataType::Int => or_fail(parse_int(text)),
        DataType::Float => or_fail(parse_float(text).map(Value::Float)),
        DataType::Bool => truth(text),
        DataType::List | DataType::Dict | DataType::Tuple => of_literal(text, data_type),
        DataType::Set => Conversion::Value(characters(text)),
        DataType::Object => match literal::parse(text.trim_start_matches([' ', '\t'])) {
            Ok(value) => Conversion::Value(value),
            Err(LiteralError::NeedsPython(_)) => Conversion::NeedsPython,
            Err(LiteralError::Syntax { .. }) => Conversion::Value(Value::str(text)),
        },
        DataType::Named(_) => Conversion::NeedsPython,
    }
}

/// A literal of exactly this type.
fn of_literal(text: &str, data_type: &DataType) -> Conversion {
    match literal::parse(text) {
        Ok(value) if DataType::of(&value).as_ref() == Some(data_type) => Conversion::Value(value),
        Ok(value) => fails(&value, data_type),
        Err(LiteralError::NeedsPython(_)) => Conversion::NeedsPython,
        Err(error) => not_a_literal(text, &error),
    }
}

fn not_a_literal(text: &str, error: &LiteralError) -> Conversion {
    Conversion::Fails(format_smolstr!("{text:?} is not a Python literal ({error})"))
}

/// Truth value of the literal in Python.
fn truth(text: &str) -> Conversion {
    let value = match literal::parse(text) {
        Ok(value) => value,
        Err(LiteralError::NeedsPython(_)) => return Conversion::NeedsPython,
        Err(error) => return not_a_literal(text, &error),
    };
    Conversion::Value(Value::Bool(match &value {
        Value::None => false,
        Value::Bool(truth) => *truth,
        Value::Int(number) => *number != 0,
        Value::Float(number) => *number != 0.0,
        Value::Str(text) => !text.is_empty(),
        Value::List(items) | Value::Tuple(items) | Value::Set(items) => !items.is_empty(),
        Value::Dict(members) => !members.is_empty(),
        Value::BigInt(_) | Value::Type(_) | Value::Encoded(_) => true,
    }))
}

/// The result of `set(text)`.
fn characters(text: &str) -> Value {
    let mut seen: Vec<char> = Vec::new();
    for c in text.chars() {
        if !seen.contains(&c) {
            seen.push(c);
        }
    }
    Value::Set(seen.into_iter().map(|c| Value::str(c.encode_utf8(&mut [0; 4]))).collect())
}

#[cfg(test)]
mod tests {
    use super::{Conversion, convert, convert_runtime_value};
    use crate::{DataType, Value, literal};
    use expect_test::{Expect, expect};

    fn shown(conversion: Conversion) -> String {
        match conversion {
            Conversion::Value(value) => {
                literal::write(&value).unwrap_or_else(|| format!("{value:?}"))
            }
            Conversion::Global(name) => format!("${name}"),
            Conversion::NeedsPython => "needs Python".to_owned(),
            Conversion::Fails(reason) => format!("!! {reason}"),
        }
    }

    fn check(data_type: &str, values: &[&str], expect: &Expect) {
        let data_type = DataType::from_file(data_type);
        let one = |text: &&str| {
            let value = literal::parse(text).unwrap_or_else(|_| Value::str(text));
            format!("{text} => {}", shown(convert(&value, &data_type)))
        };
        expect.assert_eq(&values.iter().map(one).collect::<Vec<_>>().join("\n"));
    }

    #[test]
    fn texts_become_numbers() {
        check(
            "int",
            &["'5'", "' -1_000 '", "'3.5'", "'five'", "'٣'", "5", "True", "1.0"],
            &expect![[r#"
                '5' => 5
                ' -1_000 ' => -1000
                '3.5' => !! "3.5" is not of the type int
                'five' => !! "five" is not of the type int
                '٣' => needs Python
                5 => 5
                True => True
                1.0 => !! 1.0 is not of the type int"#]],
        );
        check(
            "float",
            &["'5'", "'1e3'", "' nan'", "'Infinity'", "'x'", "5", "'e5'"],
            &expect![[r#"
            '5' => 5.0
            '1e3' => 1000.0
            ' nan' => Float(NaN)
            'Infinity' => Float(inf)
            'x' => !! "x" is not of the type float
            5 => !! 5 is not of the type float
            'e5' => !! "e5" is not of the type float"#]],
        );
        check(
            "bool",
            &["'0'", "'1'", "'[]'", "'yes'", "False", "1"],
            &expect![[r#"
            '0' => False
            '1' => True
            '[]' => False
            'yes' => !! "yes" is not a Python literal (character 0: not a Python literal)
            False => False
            1 => !! 1 is not of the type bool"#]],
        );
    }

    #[test]
    fn texts_become_containers() {
        check(
            "list",
            &["'[1, 2]'", "'(1, 2)'", "'[1'", "[1]", "(1,)"],
            &expect![[r#"
            '[1, 2]' => [1, 2]
            '(1, 2)' => !! (1, 2) is not of the type list
            '[1' => !! "[1" is not a Python literal (character 2: expected a comma or the closing bracket)
            [1] => [1]
            (1,) => !! (1,) is not of the type list"#]],
        );
        check(
            "dict",
            &["'{1: 2}'", "'{}'", "{}"],
            &expect![[r"
            '{1: 2}' => {1: 2}
            '{}' => {}
            {} => {}"]],
        );
        check(
            "tuple",
            &["'(1,)'", "'1,'", "''"],
            &expect![[r#"
                '(1,)' => (1,)
                '1,' => (1,)
                '' => !! "" is not a Python literal (character 0: the text ends where a value should be)"#]],
        );
        check(
            "set",
            &["'aba'", "{1}"],
            &expect![[r#"
            'aba' => {"a", "b"}
            {1} => {1}"#]],
        );
    }

    #[test]
    fn texts_stay_texts_where_nothing_else_is_declared() {
        check(
            "str",
            &["'5'", "'None'", "'$speed'", "'$'", "5"],
            &expect![[r#"
            '5' => "5"
            'None' => None
            '$speed' => $speed
            '$' => "$"
            5 => !! 5 is not of the type str"#]],
        );
        check(
            "object",
            &["'5'", "'hello'", "'say \"no\"'", "b'x'", "'[1]'", "{1: 2}"],
            &expect![[r#"
            '5' => 5
            'hello' => "hello"
            'say "no"' => "say \"no\""
            b'x' => needs Python
            '[1]' => [1]
            {1: 2} => {1: 2}"#]],
        );
        check(
            "None",
            &["'5'", "'$x'", "5"],
            &expect![[r#"
            '5' => "5"
            '$x' => $x
            5 => 5"#]],
        );
    }

    #[test]
    fn other_types_are_left_to_python() {
        check(
            "numpy.ndarray",
            &["'[1]'", "None", "'None'", "'$map'", "[1]"],
            &expect![[r"
            '[1]' => needs Python
            None => None
            'None' => None
            '$map' => $map
            [1] => needs Python"]],
        );
    }

    #[test]
    fn in_a_runtime_value_none_is_a_text() {
        let shown = shown(convert_runtime_value(&Value::str("None"), &DataType::Str));
        expect![[r#""None""#]].assert_eq(&shown);
    }
}
