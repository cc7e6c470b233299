#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "app/check/program_use.h"
#include "app/check/setup_sheet.h"
#include "app/report/sheet/sheet_picture.h"
#include "app/report/sheet/sheet_words.h"
#include "app/setup/stated_setup.h"

namespace app {

struct CheckRun;
struct PreparedCheck;

/// All that a set-up sheet says, besides the result of the check.
struct SheetContent {
    SetupSheet sheet;
    ProgramUse use;
    StatedSetup stated; // by the text of the set-up; nothing if it was inferred
    std::set<core::OffsetNumber> stated_lengths; // H numbers with a length in the set-up
    std::string control;                         // "fanuc", "fanuc-0i-mf"
    std::string setup_sha256;                    // of its text; empty if there is none
    bool has_unsaved_edits = false;              // the text is not that of the file
    bool calls_zero_datum = false;               // Klartext: there is no G54
    bool tolerances_were_stopped = false;        // by the user: some are missing
    bool touches_off = false;                    // assumed: Z is touched off with each tool
    SheetUnit unit;
    SheetPictures pictures;
    std::string program_date, check_date; // "2026-11-27 05:50"; empty: not known
};

/// The content of a sheet after read_check, without pictures and dates. `setup_text`: the text of
/// the set-up file; may be empty.
SheetContent sheet_content(const PreparedCheck& check, const std::string& setup_text);

/// The work offsets that the program uses, with their zeros; the first is the one to which the
/// positions on the sheet refer.
std::vector<NamedZero> zeros_of(const SheetContent& content);

/// The set-up sheet of a checked program as one self-contained HTML file that prints on A4 and
/// Letter paper: heading and verdict, pictures, datum, stock, fixtures and tools, with the
/// tolerances of the run, if any. A second page repeats the heading.
///
/// Cost: linear in the lengths of the lists.
std::string html_sheet(const CheckRun& run, const SheetContent& content);

/// The tables of a sheet, as HTML.
std::string sheet_tables(const CheckRun& run, const SheetContent& content);

/// The parts of the page that do not depend on the check.
struct SheetAssets {
    std::string_view page;  // with {{name}}s to be replaced
    std::string_view style; // CSS
};
SheetAssets sheet_assets();

} // namespace app
