//! Values of a client that name classes: nothing is imported or constructed from them.

use crate::harness::Place;
use expect_test::{Expect, expect};

const SAYS_ITS_INPUT: &str = r#"
    execution ROOT "Root"
      outcome success
      in value: object
      script |
        def execute(self, inputs, outputs, gvm):
            self.logger.info(repr(inputs["value"]))
            return "success"
"#;

/// Runs a machine with this input, in a folder with a module that leaves a file when it is imported.
fn check(value: &str, expect: &Expect) {
    let place = Place::with(SAYS_ITS_INPUT);
    let module = "import pathlib\npathlib.Path(__file__).with_suffix('.imported').touch()\n\
                  class Robot:\n    from_dict = classmethod(lambda cls, members: cls())\n";
    std::fs::write(place.path("reset_robot.py"), module).unwrap();
    let answer = place.run(&format!("--input value={value}"));
    let imported = place.path("reset_robot.imported").exists();
    expect.assert_eq(&format!("{}{}imported: {imported}\n", answer.ending(), answer.log()));
}

#[test]
fn a_type_of_a_module_is_refused_without_importing_it() {
    check(
        r#"{"__type__":"reset_robot.Robot"}"#,
        &expect![[r#"
            1 load_failed
            error: the value for input "value" cannot be used: a client's value names the class 'reset_robot.Robot', and no class is imported for a client: send plain JSON, and let a script make the object
            imported: false
        "#]],
    );
}

#[test]
fn an_object_is_refused_without_importing_its_class() {
    check(
        r#"[{"__jsonqualname__":"reset_robot.Robot"}]"#,
        &expect![[r#"
            1 load_failed
            error: the value for input "value" cannot be used: a client's value names the class 'reset_robot.Robot', and no class is imported for a client: send plain JSON, and let a script make the object
            imported: false
        "#]],
    );
}

#[test]
fn plain_data_arrives() {
    check(
        r#"[{"__jsonqualname__":"builtins.tuple","items":[1,{"2":null}]},{"__type__":"__builtin__.int"}]"#,
        &expect![[r"
            0 finished success
            [(1, {2: None}), <class 'int'>]
            imported: false
        "]],
    );
}
