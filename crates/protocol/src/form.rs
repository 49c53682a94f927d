//! Checks the forms of questions, and answers against them.

use crate::Form;
use serde_json::Value;

impl Form {
    /// Checks an answer against the form. The error contains the fault and the remedy.
    pub fn takes(&self, answer: &Value) -> Result<(), String> {
        button(answer, self.buttons())?;
        match self {
            Self::Buttons { .. } => Ok(()),
            Self::Text { .. } => match answer.get("text") {
                Some(Value::String(_)) => Ok(()),
                _ => Err("the answer needs a \"text\", which is a string".to_owned()),
            },
            Self::Number { minimum, maximum, whole, .. } => {
                number(answer, *minimum, *maximum, *whole)
            }
            Self::Checks { boxes, .. } => checked(answer, boxes.len()),
        }
    }

    /// Checks that the form can be answered. The error contains the remedy.
    pub fn check(&self) -> Result<(), String> {
        if self.buttons().is_empty() {
            return Err("a question needs a button at least, or it cannot be answered".to_owned());
        }
        match self {
            Self::Number { minimum: Some(minimum), maximum: Some(maximum), .. }
                if minimum > maximum =>
            {
                Err(format!("no number is between {minimum} and {maximum}; exchange the bounds"))
            }
            Self::Buttons { .. }
            | Self::Text { .. }
            | Self::Number { .. }
            | Self::Checks { .. } => Ok(()),
        }
    }

    /// Returns the labels of the buttons, from the left.
    pub fn buttons(&self) -> &[String] {
        match self {
            Self::Buttons { buttons }
            | Self::Text { buttons, .. }
            | Self::Number { buttons, .. }
            | Self::Checks { buttons, .. } => buttons,
        }
    }
}

fn button(answer: &Value, buttons: &[String]) -> Result<(), String> {
    let index = answer.get("button").and_then(Value::as_u64);
    match index.and_then(|index| usize::try_from(index).ok()) {
        Some(index) if index < buttons.len() => Ok(()),
        Some(index) => Err(format!(
            "there is no button {index}; the buttons are {}, counted from 0",
            buttons.join(", ")
        )),
        None => Err("the answer needs a \"button\": its number, counted from 0".to_owned()),
    }
}

fn number(
    answer: &Value,
    minimum: Option<f64>,
    maximum: Option<f64>,
    whole: bool,
) -> Result<(), String> {
    let number = answer.get("number").and_then(Value::as_f64).filter(|number| number.is_finite());
    let Some(number) = number else {
        return Err("the answer needs a \"number\"".to_owned());
    };
    if whole && number.fract() != 0.0 {
        return Err(format!("{number} is not a whole number"));
    }
    match (minimum, maximum) {
        (Some(minimum), _) if number < minimum => {
            Err(format!("{number} is too small; the least is {minimum}"))
        }
        (_, Some(maximum)) if number > maximum => {
            Err(format!("{number} is too large; the most is {maximum}"))
        }
        _ => Ok(()),
    }
}

fn checked(answer: &Value, boxes: usize) -> Result<(), String> {
    let ticks = answer.get("checked").and_then(Value::as_array);
    match ticks.filter(|ticks| ticks.iter().all(Value::is_boolean)) {
        Some(ticks) if ticks.len() == boxes => Ok(()),
        Some(ticks) => Err(format!(
            "\"checked\" has {} entries; it needs one for each of the {boxes} boxes",
            ticks.len()
        )),
        None => Err("the answer needs \"checked\": a list of true and false".to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use crate::Form;
    use expect_test::{Expect, expect};
    use serde_json::{Value, json};

    fn check(form: &Form, answer: &Value, expect: &Expect) {
        expect.assert_eq(&form.takes(answer).map_or_else(|why| why, |()| "taken".to_owned()));
    }

    fn buttons() -> Vec<String> {
        vec!["OK".to_owned(), "Cancel".to_owned()]
    }

    #[test]
    fn a_button_is_one_of_those_there_are() {
        let form = Form::Buttons { buttons: buttons() };
        check(&form, &json!({"button": 1}), &expect!["taken"]);
        check(
            &form,
            &json!({"button": 2}),
            &expect!["there is no button 2; the buttons are OK, Cancel, counted from 0"],
        );
        check(
            &form,
            &json!(1),
            &expect![[r#"the answer needs a "button": its number, counted from 0"#]],
        );
    }

    #[test]
    fn a_number_stays_within_its_bounds() {
        let form = Form::Number {
            buttons: buttons(),
            minimum: Some(1.0),
            maximum: Some(9.5),
            initial: None,
            whole: true,
        };
        let answer = |number: Value| json!({"button": 0, "number": number});
        check(&form, &answer(json!(9)), &expect!["taken"]);
        check(&form, &answer(json!(1.5)), &expect!["1.5 is not a whole number"]);
        check(&form, &answer(json!(0)), &expect!["0 is too small; the least is 1"]);
        check(&form, &answer(json!(10)), &expect!["10 is too large; the most is 9.5"]);
        check(&form, &answer(json!("9")), &expect![[r#"the answer needs a "number""#]]);
    }

    #[test]
    fn boxes_and_texts_are_all_there() {
        let boxes = vec!["left".to_owned(), "right".to_owned()];
        let form = Form::Checks { buttons: buttons(), boxes, initial: Vec::new() };
        check(&form, &json!({"button": 0, "checked": [true, false]}), &expect!["taken"]);
        check(
            &form,
            &json!({"button": 0, "checked": [true]}),
            &expect![[r#""checked" has 1 entries; it needs one for each of the 2 boxes"#]],
        );
        let form = Form::Text { buttons: buttons(), initial: String::new() };
        check(&form, &json!({"button": 0, "text": ""}), &expect!["taken"]);
        check(
            &form,
            &json!({"button": 0}),
            &expect![[r#"the answer needs a "text", which is a string"#]],
        );
    }
}
