//! Name and parameters, as reports show them.

/// Name and parameters of a problem or an engine, as reports show them.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Description {
    /// Its name, `"unnamed"` by default.
    pub name: String,
    /// Its parameters as text, in a fixed order.
    pub parameters: Vec<(String, String)>,
}

impl Default for Description {
    fn default() -> Self {
        Self {
            name: "unnamed".to_owned(),
            parameters: Vec::new(),
        }
    }
}
