//! The codes of the catalogue.

/// Declares the codes, each with the name that a user sees and that its refused model has in the tests.
macro_rules! codes {
    ($($(#[$doc:meta])* $code:ident = $name:literal,)*) => {
        /// What kind of mistake.
        #[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Debug)]
        pub enum Code {
            $($(#[$doc])* $code,)*
        }

        impl Code {
            /// Every code of the catalogue.
            pub const ALL: &[Code] = &[$(Code::$code),*];

            /// The name, as in `qcar::unknown_name`.
            pub fn name(self) -> &'static str {
                match self {
                    $(Code::$code => $name,)*
                }
            }
        }
    };
}

codes! {
    /// A character that the language does not know.
    ForeignCharacter = "foreign_character",
    /// A sentence that does not end on its line.
    UnterminatedText = "unterminated_text",
    /// An opening bracket without its closing one.
    UnclosedBracket = "unclosed_bracket",
    /// A closing bracket that closes nothing.
    StrayBracket = "stray_bracket",
    /// Brackets or expressions nested beyond reason.
    NestedTooDeep = "nested_too_deep",
    /// What the lexer refuses for any other reason.
    Unreadable = "unreadable",
    /// A number that is not finite.
    NumberTooLarge = "number_too_large",
    /// Something other than what the grammar expects.
    Expected = "expected",
    /// Two values side by side.
    MissingOperator = "missing_operator",
    /// `==` between values.
    EqualityOfValues = "equality_of_values",
    /// `N/m s`
    AmbiguousUnit = "ambiguous_unit",
    /// A statement that begins with an unknown word.
    UnknownStatement = "unknown_statement",
    /// A statement in a block where it means nothing.
    MisplacedStatement = "misplaced_statement",
    /// A patch where a model is expected.
    EffectIsNoModel = "effect_is_no_model",
    /// A name that Rust, the language or a unit has taken.
    ReservedName = "reserved_name",
    /// A name that is not in lower case.
    NameNotLowerCase = "name_not_lower_case",
    /// No model in a file, or several.
    NotOneModel = "not_one_model",
}
