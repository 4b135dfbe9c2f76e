//! The examples of the macros, as their documentation shows them.

mod axle {
    include!("../src/axle_example.txt");

    #[test]
    fn the_example_of_a_model_in_place_runs() {
        main();
    }
}

mod axle_file {
    include!("../src/axle_file_example.txt");

    #[test]
    fn the_example_of_a_model_file_runs() {
        main();
    }
}
