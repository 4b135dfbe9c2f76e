//! The codes of the catalogue.

/// Declares the codes, each with the name that a user sees. The tests refuse a model of the same name.
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

impl Code {
    /// True for mistakes of units. They depend on the expression alone, so they remain mistakes if other parts of the
    /// text cannot be read.
    pub fn is_of_units(self) -> bool {
        use Code::{ArgumentHasUnit, NotCoherent, OddExponent, UnitsDiffer, UnknownUnit, WrongUnit};
        matches!(
            self,
            UnknownUnit | NotCoherent | OddExponent | UnitsDiffer | WrongUnit | ArgumentHasUnit
        )
    }
}

codes! {
    /// A character that the language does not know.
    ForeignCharacter = "foreign_character",
    /// A sentence that does not end on its line.
    UnterminatedText = "unterminated_text",
    /// An opening bracket without its closing one.
    UnclosedBracket = "unclosed_bracket",
    /// A comment without its closing mark.
    UnclosedComment = "unclosed_comment",
    /// A closing bracket that closes nothing.
    StrayBracket = "stray_bracket",
    /// Brackets or expressions that are nested too deeply, or too long.
    NestedTooDeep = "nested_too_deep",
    /// What the lexer refuses for any other reason.
    Unreadable = "unreadable",
    /// A number that is not finite.
    NumberTooLarge = "number_too_large",
    /// A token that the grammar does not allow at this place.
    Expected = "expected",
    /// Two values side by side.
    MissingOperator = "missing_operator",
    /// `==` between values.
    EqualityOfValues = "equality_of_values",
    /// `N/m s`
    AmbiguousUnit = "ambiguous_unit",
    /// A statement that begins with an unknown word.
    UnknownStatement = "unknown_statement",
    /// A statement in the wrong kind of block.
    MisplacedStatement = "misplaced_statement",
    /// A patch where a model is expected.
    EffectIsNoModel = "effect_is_no_model",
    /// A name that Rust, the language or a unit reserves.
    ReservedName = "reserved_name",
    /// A name that is not in lower case.
    NameNotLowerCase = "name_not_lower_case",
    /// No model in a file, or several.
    NotOneModel = "not_one_model",
    /// A family's file that cannot be read.
    FamilyNotLoaded = "family_not_loaded",
    /// `from` with a file that contains no family.
    NotAFamily = "not_a_family",
    /// A choice or condition of an option that the family does not have.
    UnknownOption = "unknown_option",
    /// A value that an option cannot have.
    UnknownValue = "unknown_value",
    /// An option without default that an axle does not choose.
    OptionNotChosen = "option_not_chosen",
    /// A `require` that the chosen options break.
    RequirementFailed = "requirement_failed",
    /// An option that no condition asks about.
    UnusedOption = "unused_option",
    /// A name that is declared twice.
    DuplicateName = "duplicate_name",
    /// A name that is not declared.
    UnknownName = "unknown_name",
    /// A name whose declaration is switched off by an option.
    SwitchedOff = "switched_off",
    /// A derived quantity used above its declaration.
    UsedBeforeDeclared = "used_before_declared",
    /// A parameter or derived quantity of the model, used inside an element.
    ElementIsClosed = "element_is_closed",
    /// `s` or `v` outside of a law.
    LawVariableOutside = "law_variable_outside",
    /// A coordinate where only parameters are known.
    CoordinateInExpression = "coordinate_in_expression",
    /// A name that exists in several directions, used without its direction.
    AmbiguousDirection = "ambiguous_direction",
    /// A direction that the model does not have.
    UnknownDirection = "unknown_direction",
    /// A function that the language does not have.
    UnknownFunction = "unknown_function",
    /// A function or element with the wrong number of arguments.
    WrongArguments = "wrong_arguments",
    /// An element that the file does not have.
    UnknownElement = "unknown_element",
    /// An element that contains itself.
    RecursiveElement = "recursive_element",
    /// An element that no law uses.
    UnusedElement = "unused_element",
    /// A derived quantity that nothing uses.
    UnusedLet = "unused_let",
    /// A second gravity in one direction.
    SecondGravity = "second_gravity",
    /// A force or gravity that is used like a coordinate, a link that is used like a mass, and so on.
    WrongKind = "wrong_kind",
    /// A force input on a prescribed motion.
    ForceOnPrescribed = "force_on_prescribed",
    /// A quantity that the point or link does not have.
    UnknownQuantity = "unknown_quantity",
    /// A parameter whose default refers to itself, directly or through other parameters.
    CircularDefault = "circular_default",
    /// A symbol that is no unit.
    UnknownUnit = "unknown_unit",
    /// A declaration in a unit that is not coherent with kg, m and s.
    NotCoherent = "not_coherent",
    /// An exponent of a unit that is no multiple of 1/6.
    OddExponent = "odd_exponent",
    /// Summands, branches or sides of different units.
    UnitsDiffer = "units_differ",
    /// A quantity in a unit other than the required one.
    WrongUnit = "wrong_unit",
    /// A function, such as `exp`, of a quantity with a unit.
    ArgumentHasUnit = "argument_has_unit",
    /// A quantity with a unit, raised to an exponent that is not a constant.
    ExponentNotConstant = "exponent_not_constant",
    /// A constant expression without a finite value.
    NotFinite = "not_finite",
    /// A table whose numbers of abscissae and ordinates differ.
    TableLengthsDiffer = "table_lengths_differ",
    /// A table with fewer than two points, or too many.
    TableSize = "table_size",
    /// An abscissa of a table that is not a constant.
    TableNotConstant = "table_not_constant",
    /// Abscissae of a table out of order.
    TableNotIncreasing = "table_not_increasing",
    /// A division by a literal zero.
    DivisionByZero = "division_by_zero",
    /// A stretch that is not linear in the coordinates.
    StretchNotLinear = "stretch_not_linear",
    /// A constant in a stretch.
    StretchHasConstant = "stretch_has_constant",
    /// A stretch in which all coordinates cancel.
    StretchVanishes = "stretch_vanishes",
    /// A stretch that is neither a length nor an angle.
    StretchUnit = "stretch_unit",
    /// A link whose law is empty.
    EmptyLaw = "empty_law",
    /// A state whose rate is not given.
    StateWithoutRate = "state_without_rate",
    /// A rate of a name that is not a state.
    RateWithoutState = "rate_without_state",
    /// A state whose rate is given twice.
    SecondRate = "second_rate",
    /// A `rolling` block in a link without a road.
    RollingWithoutRoad = "rolling_without_road",
    /// States or rates inside `rolling`.
    RollingChangesStates = "rolling_changes_states",
    /// A second `rolling` block, or one outside of a link.
    SecondRolling = "second_rolling",
    /// A range whose bounds are in the wrong order.
    RangeReversed = "range_reversed",
    /// A default outside of the declared range.
    DefaultOutsideRange = "default_outside_range",
    /// A parameter that nothing uses.
    UnusedParameter = "unused_parameter",
    /// A second state with the same name in one law.
    SecondState = "second_state",
    /// A coefficient of a linear term that depends on the motion.
    CoefficientVaries = "coefficient_varies",
    /// Masses that no link holds.
    MassNotHeld = "mass_not_held",
    /// Masses whose weight no spring carries.
    MassSinks = "mass_sinks",
    /// A node that no link touches.
    NodeNotAttached = "node_not_attached",
    /// A node whose balance is a nonlinear equation.
    NodeNonlinear = "node_nonlinear",
    /// Nodes that are connected only to each other.
    NodesFloat = "nodes_float",
    /// An inertia that is zero or negative at its defaults or everywhere.
    InertiaNotPositive = "inertia_not_positive",
    /// An inertia that is a parameter whose range begins at zero or below.
    InertiaCanVanish = "inertia_can_vanish",
    /// A damper or inerter that can be negative.
    NegativeDamping = "negative_damping",
    /// A law that supplies energy.
    LawGivesEnergy = "law_gives_energy",
    /// Two links with the same stretch and the same kind of term.
    DuplicateLink = "duplicate_link",
    /// A prescribed motion that no link touches.
    MotionNotUsed = "motion_not_used",
    /// A law of several stretches at a massless node.
    CoupledAtNode = "coupled_at_node",
    /// A force input that acts on nothing.
    ForceNotUsed = "force_not_used",
    /// A motion of a massless node that would need the rate of a force input.
    ForceRateNeeded = "force_rate_needed",
    /// A gravity in a direction without masses.
    GravityPullsNothing = "gravity_pulls_nothing",
    /// A model without outputs.
    NoOutputs = "no_outputs",
    /// A model that no input moves.
    NoExcitation = "no_excitation",
    /// A parameter that no response depends on.
    ParameterUndetermined = "parameter_undetermined",
    /// Parameters that affect the outputs only in combination.
    OnlyInCombination = "only_in_combination",
    /// No effect in a file, or several.
    NotOneEffect = "not_one_effect",
    /// An effect that does not say what it is, where it comes from or how it shows.
    EffectNotDescribed = "effect_not_described",
    /// A kind of linear term that the language does not have.
    UnknownTerm = "unknown_term",
    /// A role that no part of a model has.
    UnknownRole = "unknown_role",
    /// An effect of a sensor that changes the model.
    SensorChangesModel = "sensor_changes_model",
    /// A place that the pattern of an effect does not fit.
    NoSuchPlace = "no_such_place",
    /// A property that an effect uses and that its place does not have.
    PlaceLacks = "place_lacks",
    /// A name that an effect declares and the model has already.
    AlreadyInModel = "already_in_model",
    /// A state that an effect declares and the link has already.
    AlreadyInLink = "already_in_link",
    /// A start or bound in a unit other than that of its parameter.
    StartOfOtherUnit = "start_of_other_unit",
    /// A start that is not between its bounds.
    StartOutsideRange = "start_outside_range",
    /// A second strength of a form.
    SecondStrength = "second_strength",
    /// A strength whose vanishing value is outside of its range.
    VanishesOutsideRange = "vanishes_outside_range",
}
