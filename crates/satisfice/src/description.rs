//! Name and parameters, as reports show them.

/// Name and parameters of a problem or an engine, as reports show them.
///
/// ```
/// use satisfice::Description;
/// let description = Description { name: "ring".to_owned(), parameters: vec![("radius".to_owned(), "2".to_owned())] };
/// assert_eq!(Description::default().name, "unnamed");
/// # let _ = description;
/// ```
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
