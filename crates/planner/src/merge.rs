//! Merges the skills of a pool into one domain. Findings name the libraries that contradict each other.

use crate::finding::Finding;
use crate::pddl::{Domain, Name, OBJECT, Signature, Term, Typed};
use crate::skill::Skill;
use smol_str::SmolStr;
use std::collections::{BTreeMap, BTreeSet};

/// A domain with the skills of its actions.
#[derive(Debug, Clone)]
pub struct Pool {
    /// The domain merged from the skills.
    pub domain: Domain,
    /// All skills, sorted by library.
    pub skills: Vec<Skill>,
    /// Problems found during the merge.
    pub findings: Vec<Finding>,
}

impl Pool {
    /// Merges the skills. Each entry of `types` is a type and its parent.
    pub fn new(name: &str, mut skills: Vec<Skill>, types: &[(Name, Name)]) -> Self {
        skills.sort_by(|a, b| a.library.cmp(&b.library));
        let mut pool = Self {
            domain: Domain { name: name.into(), ..Domain::default() },
            skills,
            findings: Vec::new(),
        };
        if pool.skills.is_empty() {
            pool.findings.push(Finding::error(
                &[],
                "the pool has no skills: none of its libraries has a planner annotation",
            ));
        }
        pool.take_types(types);
        pool.take_actions();
        pool.take_signatures();
        pool.check_parameters();
        let requirements = pool.skills.iter().flat_map(|skill| skill.requirements.iter().cloned());
        pool.domain.requirements = requirements.collect::<BTreeSet<_>>().into_iter().collect();
        pool
    }

    /// The skill of an action.
    pub fn skill(&self, action: &str) -> Option<&Skill> {
        self.skills.iter().find(|skill| skill.action.name == action)
    }

    fn take_types(&mut self, given: &[(Name, Name)]) {
        let mut parents: BTreeMap<Name, (Name, Option<&SmolStr>)> = BTreeMap::new();
        let declared = self.skills.iter().flat_map(|skill| {
            skill.types.iter().filter_map(move |(child, parent)| {
                Some((child, parent.as_ref()?, Some(&skill.library)))
            })
        });
        let given_types = given.iter().map(|(child, parent)| (child, parent, None));
        for (child, parent, by) in given_types.chain(declared) {
            let (child, parent) =
                (child.to_ascii_lowercase().into(), Name::from(parent.to_ascii_lowercase()));
            match parents.get(&child) {
                // A narrower parent takes precedence over `object`.
                Some((other, _)) if *other != parent && parent == OBJECT => {}
                Some((other, before)) if *other != parent && *other != OBJECT => {
                    let libraries: Vec<_> = before.iter().copied().chain(by).collect();
                    let text = format!(
                        "the type `{child}` is a kind of `{other}` and of `{parent}`: decide for one"
                    );
                    self.findings.push(Finding::error(&libraries, text));
                }
                Some((other, _)) if *other == parent => {}
                None if child == OBJECT => {}
                _ => drop(parents.insert(child, (parent, by))),
            }
        }
        let mut types: BTreeMap<Name, Name> =
            parents.into_iter().map(|(child, (parent, _))| (child, parent)).collect();
        for (name, library) in used_types(&self.skills) {
            if name != OBJECT && !types.contains_key(&name) {
                if !given.is_empty()
                    && !given.iter().any(|(_, parent)| parent.eq_ignore_ascii_case(&name))
                {
                    let text = format!(
                        "the type `{name}` is missing among the types: it is taken as a kind of object"
                    );
                    self.findings.push(Finding::warning(&[&library], text));
                }
                types.insert(name, OBJECT.into());
            }
        }
        let above: Vec<Name> = types
            .values()
            .filter(|parent| *parent != OBJECT && !types.contains_key(*parent))
            .cloned()
            .collect();
        types.extend(above.into_iter().map(|name| (name, OBJECT.into())));
        self.domain.types = types.into_iter().collect();
        self.break_circles();
    }

    fn break_circles(&mut self) {
        let names: Vec<Name> = self.domain.types.iter().map(|(child, _)| child.clone()).collect();
        for name in names {
            let line: Vec<Name> = self.domain.line(&name).into_iter().map(Name::new).collect();
            let last = line.iter().rev().find(|kind| *kind != OBJECT);
            let next =
                last.and_then(|last| self.domain.types.iter_mut().find(|(child, _)| child == last));
            if let Some((_, parent)) = next.filter(|(_, parent)| parent != OBJECT) {
                *parent = OBJECT.into();
                let text = format!(
                    "the types `{}` form a circle: each is a kind of the next",
                    line[..line.len() - 1].join("`, `")
                );
                self.findings.push(Finding::error(&[], text));
            }
        }
    }

    fn take_actions(&mut self) {
        let mut by_name: BTreeMap<&Name, Vec<&Skill>> = BTreeMap::new();
        for skill in &self.skills {
            by_name.entry(&skill.action.name).or_default().push(skill);
        }
        let twice = by_name.iter().filter(|(_, skills)| skills.len() > 1);
        self.findings.extend(twice.map(|(name, skills)| {
            let libraries: Vec<_> = skills.iter().map(|skill| &skill.library).collect();
            Finding::error(
                &libraries,
                format!("each is the action `{name}`: rename it in all but one"),
            )
        }));
        let firsts = by_name.values().filter_map(|skills| skills.first());
        self.domain.actions = firsts.map(|skill| skill.action.clone()).collect();
    }

    fn take_signatures(&mut self) {
        let (mut predicates, mut functions) = (Vec::new(), Vec::new());
        for skill in &self.skills {
            let [used, counted] = skill.used();
            let library = &skill.library;
            let declared =
                |name: &Name| skill.predicates.iter().any(|signature| signature.name == *name);
            if !skill.predicates.is_empty() {
                let missing: BTreeSet<_> = used
                    .iter()
                    .map(|signature| &signature.name)
                    .filter(|name| !declared(name))
                    .collect();
                self.findings.extend(missing.into_iter().map(|name| {
                    Finding::warning(
                        &[library],
                        format!("`{name}` is used in the action and missing among its predicates"),
                    )
                }));
            }
            predicates.extend(
                skill.predicates.iter().cloned().chain(used).map(|signature| (library, signature)),
            );
            functions.extend(
                skill
                    .functions
                    .iter()
                    .cloned()
                    .chain(counted)
                    .map(|signature| (library, signature)),
            );
        }
        let mut findings = Vec::new();
        let predicates = merged(&self.domain, predicates, &mut findings);
        let functions = merged(&self.domain, functions, &mut findings);
        for both in functions
            .iter()
            .filter(|function| predicates.iter().any(|predicate| predicate.name == function.name))
        {
            findings.push(Finding::error(
                &[],
                format!("`{}` is a predicate and a number: rename one", both.name),
            ));
        }
        (self.domain.predicates, self.domain.functions) = (predicates, functions);
        self.findings.extend(findings);
    }

    fn check_parameters(&mut self) {
        for skill in &self.skills {
            let library = &skill.library;
            let mut seen = BTreeSet::new();
            for parameter in &skill.action.parameters {
                if !seen.insert(&parameter.name) {
                    self.findings.push(Finding::error(
                        &[library],
                        format!("the parameter `?{}` occurs twice", parameter.name),
                    ));
                }
            }
            for stranger in skill.strangers().into_iter().collect::<BTreeSet<_>>() {
                let text = match &stranger {
                    Term::Variable(name) => format!(
                        "`?{name}` is no parameter of `{}`: add it to `:parameters`",
                        skill.action.name
                    ),
                    Term::Object(name) => format!(
                        "`{}` names the object `{name}`: make it a parameter, `?{name}`",
                        skill.action.name
                    ),
                };
                self.findings.push(Finding::error(&[library], text));
            }
            if skill.done().is_none() {
                self.findings.push(Finding::error(
                    &[library],
                    "it has no outcome that means success: add one",
                ));
            }
            let parameters = &skill.action.parameters;
            let unset = skill.root.inputs.iter().filter(|port| {
                port.default.is_none()
                    && !parameters
                        .iter()
                        .any(|parameter| parameter.name.eq_ignore_ascii_case(&port.name))
            });
            self.findings.extend(unset.map(|port| {
                let text = format!("no parameter sets the input `{0}`: name one `?{0}`, or give the input a default value", port.name);
                Finding::warning(&[library], text)
            }));
        }
    }
}

fn used_types(skills: &[Skill]) -> Vec<(Name, SmolStr)> {
    let mut all = BTreeMap::new();
    for skill in skills {
        let typed = skill.action.parameters.iter();
        let typed = typed.chain(
            skill
                .predicates
                .iter()
                .chain(&skill.functions)
                .flat_map(|signature| &signature.arguments),
        );
        let names = typed
            .flat_map(|typed| typed.types.iter())
            .chain(skill.types.iter().map(|(name, _)| name));
        for name in names {
            all.entry(name.clone()).or_insert_with(|| skill.library.clone());
        }
    }
    all.into_iter().collect()
}

/// Merges signatures by name. Each result accepts the types of all uses.
fn merged(
    domain: &Domain,
    all: Vec<(&SmolStr, Signature)>,
    findings: &mut Vec<Finding>,
) -> Vec<Signature> {
    let mut merged: BTreeMap<Name, (Signature, &SmolStr)> = BTreeMap::new();
    for (library, signature) in all {
        let Some((known, by)) = merged.get_mut(&signature.name) else {
            merged.insert(signature.name.clone(), (signature, library));
            continue;
        };
        if known.arguments.len() != signature.arguments.len() {
            let text = format!(
                "`{known}` and `{signature}` differ in their number of arguments: make them equal, or rename one"
            );
            let finding = Finding::error(&[by, library], text);
            if !findings.contains(&finding) {
                findings.push(finding);
            }
            continue;
        }
        let before = known.clone();
        for (known, other) in known.arguments.iter_mut().zip(&signature.arguments) {
            if let Some(types) = join(domain, known, other) {
                known.types = types;
            } else {
                let text = format!(
                    "`{before}` and `{signature}` take unrelated types: `{}` and `{}`; if they belong together, give them a common supertype",
                    known.types.join("` or `"),
                    other.types.join("` or `"),
                );
                findings.push(Finding::warning(&[by, library], text));
                known.types.clear();
            }
        }
    }
    merged.into_values().map(|(signature, _)| signature).collect()
}

/// The nearest types that cover both; `None` if only `object` does.
fn join(domain: &Domain, a: &Typed, b: &Typed) -> Option<Vec<Name>> {
    if a.types.is_empty() || b.types.is_empty() {
        return Some(Vec::new());
    }
    let covers = |wide: &Typed, narrow: &Typed| {
        narrow.types.iter().all(|name| domain.fits(name, &wide.types))
    };
    if covers(a, b) {
        return Some(a.types.clone());
    }
    if covers(b, a) {
        return Some(b.types.clone());
    }
    let shared = domain.line(&a.types[0]).into_iter().find(|kind| {
        let kind = [Name::new(kind)];
        a.types.iter().chain(&b.types).all(|name| domain.fits(name, &kind))
    });
    shared.filter(|kind| *kind != OBJECT).map(|kind| vec![kind.into()])
}
