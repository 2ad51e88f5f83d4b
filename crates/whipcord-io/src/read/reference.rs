use crate::check::Fields;

/// What others have published for a case: shown beside our values, never computed with.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reference {
    /// Where the values stand.
    pub source: String,
    /// RMS error of the four-bar model against the measurement in m.
    pub rms_four_bar: Option<f64>,
    /// RMS error of the Cosserat model against the measurement in m.
    pub rms_cosserat: Option<f64>,
    /// Solve time of the four-bar model in s.
    pub time_four_bar: Option<f64>,
    /// Solve time of the Cosserat model in s.
    pub time_cosserat: Option<f64>,
}

/// `[reference]`; `None` when its source is missing.
pub(crate) fn reference(fields: &Fields) -> Option<Reference> {
    Some(Reference {
        source: fields.text("source")?.to_owned(),
        rms_four_bar: fields.number("rms_four_bar"),
        rms_cosserat: fields.number("rms_cosserat"),
        time_four_bar: fields.number("time_four_bar"),
        time_cosserat: fields.number("time_cosserat"),
    })
}
