//! Tests of the program in a real window.
//!
//! The tests run programs that a computer may lack, and `#[test]` cannot ignore a test at run time.
//! So this binary has a harness of its own. The harness ignores tests whose programs are missing,
//! and says what to install. Under CI, and with `--ignored` or `--include-ignored`, these tests
//! fail instead.

#[cfg(unix)]
mod curves;
#[cfg(unix)]
mod display;
#[cfg(unix)]
mod frame;
#[cfg(unix)]
mod gallery;
#[cfg(unix)]
mod harness;
#[cfg(unix)]
mod lacking;
#[cfg(unix)]
mod newcomer;
#[cfg(unix)]
mod scene;
#[cfg(unix)]
mod session;
#[cfg(unix)]
mod sliders;
#[cfg(unix)]
mod surfaces;
#[cfg(unix)]
#[path = "../surroundings/mod.rs"]
mod surroundings;
#[cfg(unix)]
#[path = "../terminal_support/mod.rs"]
#[allow(dead_code, reason = "the prompt's tests use the rest")]
mod terminal_support;
#[cfg(unix)]
mod typing;

#[cfg(unix)]
use harness::{Group, Program};

/// Pairs each test with its path as a name.
#[cfg(unix)]
macro_rules! tests {
    ($($test:path,)*) => { &[$((stringify!($test), $test)),*] };
}

/// All tests, grouped by the programs that they run.
#[cfg(unix)]
const TESTS: &[Group] = &[
    Group {
        programs: &[],
        tests: tests![
            lacking::filters_select_what_libtest_selects,
            lacking::tests_that_must_run_fail_without_their_programs,
            lacking::tests_without_their_programs_are_ignored_with_the_reason,
        ],
    },
    Group {
        programs: &[Program::SETSID],
        tests: tests![frame::a_terminal_that_goes_away_with_a_signal_ends_the_program,],
    },
    Group {
        programs: &[
            Program::XVFB,
            Program::XDOTOOL,
            Program::XCLIP,
            Program::XPROP,
            Program::OPENBOX,
        ],
        tests: tests![
            newcomer::a_newcomer_is_at_home_on_a_small_screen,
            newcomer::a_newcomer_is_at_home_on_a_usual_screen,
            newcomer::a_newcomer_is_at_home_on_a_dense_screen,
        ],
    },
    Group {
        programs: &[Program::XVFB, Program::XDOTOOL, Program::OPENBOX],
        tests: tests![frame::f11_takes_the_whole_screen_and_gives_it_back,],
    },
    Group {
        programs: &[Program::XVFB, Program::XDOTOOL, Program::XPROP],
        tests: tests![frame::a_display_s_scale_is_followed,],
    },
    Group {
        programs: &[Program::XVFB, Program::XDOTOOL, Program::XCLIP],
        tests: tests![
            typing::fifty_formulas_typed_blind_are_drawn,
            typing::a_line_is_selected_copied_cut_pasted_and_undone,
            typing::a_wrong_formula_from_the_command_line_is_mended_in_the_line,
            typing::tab_writes_the_line_that_the_advice_gives,
            typing::other_programs_texts_are_pasted,
        ],
    },
    Group {
        programs: &[Program::XVFB, Program::XDOTOOL],
        tests: tests![
            frame::shift_drag_moves_as_the_right_button_does,
            frame::the_picture_fills_a_window_that_grows_or_shrinks,
            frame::letters_are_as_large_as_they_are_asked_to_be,
            frame::the_overlay_is_drawn_around_the_picture,
            frame::a_saved_file_is_seen_at_once,
            frame::the_close_button_asks_before_work_is_lost,
            frame::closing_the_window_ends_the_program_and_keeps_the_document,
            frame::a_terminal_that_goes_away_beside_a_window_ends_the_program,
            gallery::a_surface_is_chosen_by_its_picture,
            gallery::help_is_read_in_the_window,
            session::the_picture_is_centred_and_follows_mouse_and_keys,
            session::one_step_of_the_wheel_zooms_as_far_as_a_key,
            session::a_line_is_typed_corrected_and_entered_in_the_window,
            session::a_click_and_a_saved_picture_can_be_repeated_from_the_terminal,
            session::a_key_and_enter_save_a_mesh,
            session::saving_a_slow_picture_does_not_hold_the_window,
            sliders::a_slider_that_is_dragged_changes_picture_and_document_and_is_taken_back,
            sliders::a_slider_that_is_held_while_the_gallery_opens_is_let_go,
            sliders::a_surface_that_outgrows_the_view_is_fitted_when_the_slider_is_let_go,
            sliders::time_is_played_paused_and_scrubbed,
            sliders::a_value_runs_by_its_button_and_its_range_is_edited_in_place,
            sliders::what_faces_the_eye_is_cut_open_and_the_cut_is_moved,
            sliders::clicks_however_short_are_seen_and_each_once,
            sliders::what_is_typed_in_the_window_prints_nothing_in_the_terminal,
            sliders::the_title_names_the_document_and_whether_it_was_changed,
            surfaces::a_surface_is_colored_in_the_list_and_an_added_one_has_the_usual_color,
            surfaces::surfaces_are_hidden_seen_through_moved_and_taken_away,
            surfaces::a_curve_is_hidden_and_shown_by_a_click,
            surfaces::formulas_are_edited_and_added_in_the_list,
            surfaces::axes_are_there_unless_somebody_wants_none,
            curves::curves_are_there_while_the_view_turns,
        ],
    },
];

fn main() -> std::process::ExitCode {
    #[cfg(unix)]
    return harness::run(TESTS);
    #[cfg(not(unix))]
    std::process::ExitCode::SUCCESS
}
