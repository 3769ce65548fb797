//! Which runs of a suite are wanted: some seeds, engines, problems, budgets instead of all.

use std::ops::Range;
use std::time::Duration;

use satisfice_catalogue::quantity;
use serde::{Deserialize, Serialize};

use super::plan::check_engine;
use super::suite::{Choice, Part, Suite};
use crate::error::Error;

/// What is run of a suite. Empty lists and `None` stand for all.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Selection {
    /// The seeds used instead of those of the suite.
    pub seeds: Option<Range<u64>>,
    /// The only engines: with the parameters that a part gives them, otherwise with their defaults.
    pub engines: Vec<String>,
    /// The only problems, by name, with all their parameters.
    pub problems: Vec<String>,
    /// The only budgets: values of `evaluations` or `time`, such as `200` or `10ms`.
    pub budgets: Vec<String>,
}

impl Selection {
    /// The part of a suite that is selected.
    ///
    /// # Errors
    /// [`Error::Run`] for an engine that is unknown and a problem that is not in the suite, with the nearest; [`Error::Suite`] for a budget
    /// that is not, and for engines without the one that the suite compares with the others.
    pub fn apply(&self, mut suite: Suite) -> Result<Suite, Error> {
        self.check(&suite)?;
        for part in &mut suite.parts {
            if let Some(seeds) = &self.seeds {
                part.seeds = seeds.clone();
            }
            self.choose_engines(part);
            self.choose_problems(part);
            self.choose_budgets(part);
        }
        suite.parts.retain(|part| {
            !part.problems.is_empty() && part.options.iter().all(|(_, values)| !values.is_empty())
        });
        if let Some(regret) = &mut suite.regret {
            regret.held_back.retain(|label| self.has_problem(label));
        }
        Ok(suite)
    }

    fn check(&self, suite: &Suite) -> Result<(), Error> {
        self.engines.iter().try_for_each(|name| check_engine(name))?;
        if let Some(regret) = &suite.regret {
            let name = regret.engine.split(' ').next().unwrap_or(&regret.engine);
            if !self.engines.is_empty() && !self.engines.iter().any(|engine| engine == name) {
                return Err(Error::Suite {
                    place: suite.name.clone(),
                    what: format!(
                        "this suite compares {name} with other engines: choose it too, `--engines {name},{}`",
                        self.engines.join(",")
                    ),
                });
            }
        }
        let problems = || suite.parts.iter().flat_map(|part| &part.problems);
        for name in &self.problems {
            if !problems().any(|choice| choice.name == *name) {
                let known = problems().map(|choice| choice.name.as_str());
                return Err(satisfice::Error::unknown("problem of this suite", name, known).into());
            }
        }
        let values = || {
            suite
                .parts
                .iter()
                .flat_map(|part| &part.options)
                .filter(|(key, _)| is_budget(key))
        };
        for budget in &self.budgets {
            if !values().any(|(key, values)| values.iter().any(|value| is_same(key, value, budget))) {
                let known: Vec<&str> = values()
                    .flat_map(|(_, values)| values)
                    .map(String::as_str)
                    .collect();
                return Err(Error::Suite {
                    place: suite.name.clone(),
                    what: format!(
                        "{budget} is no budget of this suite: choose from {}",
                        known.join(", ")
                    ),
                });
            }
        }
        Ok(())
    }

    fn choose_engines(&self, part: &mut Part) {
        if self.engines.is_empty() {
            return;
        }
        let known = std::mem::take(&mut part.engines);
        for name in &self.engines {
            let mut listed = known.iter().filter(|choice| choice.name == *name).peekable();
            if listed.peek().is_none() {
                part.engines.push(Choice {
                    name: name.clone(),
                    settings: Vec::new(),
                });
            }
            part.engines.extend(listed.cloned());
        }
        part.against = part
            .against
            .take()
            .filter(|against| self.engines.contains(against));
    }

    fn choose_problems(&self, part: &mut Part) {
        part.problems.retain(|choice| self.has_problem(&choice.name));
        part.beside.retain(|label, _| self.has_problem(label));
    }

    /// Whether a problem is wanted; its label begins with its name.
    fn has_problem(&self, label: &str) -> bool {
        self.problems.is_empty()
            || self
                .problems
                .iter()
                .any(|wanted| label.split(' ').next() == Some(wanted))
    }

    fn choose_budgets(&self, part: &mut Part) {
        if !self.budgets.is_empty() {
            for (key, values) in part.options.iter_mut().filter(|(key, _)| is_budget(key)) {
                values.retain(|value| self.budgets.iter().any(|budget| is_same(key, value, budget)));
            }
        }
    }
}

fn is_budget(key: &str) -> bool {
    key == "evaluations" || key == "time"
}

/// Whether a value of a key is this budget, however it is written: 10_000 or 10k, 0.1s or 100ms.
fn is_same(key: &str, value: &str, budget: &str) -> bool {
    if key == "time" {
        let time = |text: &str| -> Option<Duration> { quantity::time(text).ok() };
        time(value).is_some_and(|value| time(budget) == Some(value))
    } else {
        let count = |text: &str| quantity::count(text).ok();
        count(value).is_some_and(|value| count(budget) == Some(value))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUITE: &str = r#"
        seeds = "0..4"
        [[part]]
        engines = ["random", "walk"]
        problems = ["queens", { name = "arm", links = [3, 4] }]
        evaluations = [50, 10_000]
        beside = { "arm links=3" = "closed form" }
        [[part]]
        engines = ["random"]
        problems = ["queens"]
        time = ["10ms", "1s"]
    "#;

    fn select(selection: &Selection) -> Result<Suite, Error> {
        selection.apply(Suite::parse("mine", SUITE)?)
    }

    #[test]
    fn what_is_not_selected_is_left_out() {
        let all = Suite::parse("mine", SUITE).unwrap();
        assert_eq!(select(&Selection::default()).unwrap(), all);
        let suite = select(&Selection {
            seeds: Some(3..5),
            engines: vec!["descent".to_owned(), "walk".to_owned()],
            problems: vec!["queens".to_owned()],
            budgets: vec!["10000".to_owned()],
        })
        .unwrap();
        let [part] = &suite.parts[..] else {
            panic!("one part")
        };
        let names = |choices: &[Choice]| {
            choices
                .iter()
                .map(|choice| choice.name.clone())
                .collect::<Vec<_>>()
        };
        assert_eq!(
            (names(&part.engines), names(&part.problems)),
            (
                vec!["descent".to_owned(), "walk".to_owned()],
                vec!["queens".to_owned()]
            )
        );
        assert_eq!(
            (part.seeds.clone(), part.options[0].1.len(), part.beside.len()),
            (3..5, 1, 0)
        );
        let timed = Selection {
            budgets: vec!["1000ms".to_owned()],
            ..Selection::default()
        };
        let suite = select(&timed).unwrap();
        assert_eq!(
            (suite.parts.len(), suite.parts[0].options[0].1.clone()),
            (1, vec!["1s".to_owned()])
        );
    }

    #[test]
    fn an_engine_that_is_misspelt_is_told_before_one_that_is_missing() {
        let suite = Suite::parse("mine", &format!("{SUITE}[regret]\nengine = \"walk\"")).unwrap();
        let refuse = |name: &str| {
            let engines = vec![name.to_owned()];
            let selection = Selection {
                engines,
                ..Selection::default()
            };
            selection.apply(suite.clone()).unwrap_err().to_string()
        };
        assert!(
            refuse("walc").contains("unknown engine `walc`, did you mean `walk`?"),
            "{}",
            refuse("walc")
        );
        for known in ["random", "grid"] {
            assert!(
                refuse(known).contains("choose it too, `--engines walk,"),
                "{known}"
            );
        }
    }

    #[test]
    fn what_is_not_in_the_suite_is_refused() {
        let problem = Selection {
            problems: vec!["quens".to_owned()],
            ..Selection::default()
        };
        assert!(
            select(&problem)
                .unwrap_err()
                .to_string()
                .contains("did you mean `queens`")
        );
        let budget = Selection {
            budgets: vec!["60".to_owned()],
            ..Selection::default()
        };
        let error = select(&budget).unwrap_err().to_string();
        assert!(
            error.contains("60 is no budget of this suite") && error.contains("50, 10000, 10ms, 1s"),
            "{error}"
        );
    }
}
