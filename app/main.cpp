#include <array>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <locale>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <sqlite3.h>

#include "app/base/text.h"
#include "app/base/version.h"
#include "app/commands/commands.h"
#include "app/commands/line_reader.h"
#include "app/commands/suggestion.h"
#include "app/report/html/html_page.h"
#include "core/base/platform.h"
#include "core/cad/cad_file.h"

namespace {

/// The version, and what this build can do.
std::string version_text() {
    const bool has_view = !app::view_bundle().empty();
    const std::string_view library = core::cad_library();
    const bool reads_cad = core::has_cad_reader();
    return fmt::format(
        "feeler {}\nwith     window and pictures (OpenGL), database of results "
        "(SQLite {}), line editing ({}){}{}{}{}",
        app::version, sqlite3_libversion(), app::line_editor(),
        has_view ? ", 3D view in HTML reports" : "",
        reads_cad ? fmt::format(", CAD files: STEP, IGES, BREP, FreeCAD ({})", library) : "",
        has_view ? "" : "\nwithout  3D view in HTML reports: npm was missing",
        reads_cad         ? ""
        : library.empty() ? "\nwithout  CAD files: Open CASCADE was missing"
                          : "\nwithout  CAD files: feeler-cad is missing");
}

/// The arguments as CLI11 reads them: debuggers have an option -ex, which it would take for -e x.
std::vector<const char*> arguments_of(const std::vector<std::string>& words) {
    std::vector<const char*> arguments;
    const bool debugs = words.size() > 1 && words[1] == "debug";
    for (const std::string& word : words)
        arguments.push_back(debugs && word == "-ex" ? "--eval-command" : word.c_str());
    return arguments;
}

int run(const std::vector<std::string>& words) {
    CLI::App cli(
        "Feeler checks NC programs for collisions, with proven clearances for every block.",
        "feeler");
    cli.set_version_flag("--version", version_text());
    cli.require_subcommand(1);
    cli.allow_windows_style_options(false); // "/x" is a path or a block that may be skipped
    app::ExitCode exit_code = app::ExitCode::clear;
    app::add_check(cli, exit_code);
    app::add_setup(cli, exit_code);
    app::add_coproc(cli, exit_code);
    app::add_trace(cli, exit_code);
    app::add_debug(cli, exit_code);
    app::add_distance(cli, exit_code);
    app::add_presets(cli, exit_code);
    app::add_view(cli, exit_code);
    app::add_shot(cli, exit_code);
    app::add_sheet(cli, exit_code);
    app::add_filter(cli, exit_code);
    app::add_guard(cli, exit_code);
    app::add_gate(cli, exit_code);
    app::add_merge(cli, exit_code);
    app::add_history(cli, exit_code);
    app::add_diff(cli, exit_code);
    app::add_bench(cli, exit_code);
    app::add_completion(cli, exit_code);
    try {
        const std::vector<const char*> arguments = arguments_of(words);
        cli.parse(static_cast<int>(arguments.size()), arguments.data());
    } catch (const CLI::ParseError& error) {
        // Help and version are no errors; every misuse is the same to a script.
        if (error.get_exit_code() == 0) return cli.exit(error);
        const std::string misspelt = app::misspelt_text(cli, arguments_of(words));
        std::fputs(fmt::format("feeler: {}\nRun with --help for more information.\n",
                               app::printable(misspelt.empty() ? error.what() : misspelt))
                       .c_str(),
                   stderr);
        return static_cast<int>(app::ExitCode::failed);
    }
    return static_cast<int>(exit_code);
}

/// Whether a file manager of Windows has opened this program: alone, with what was dropped on it,
/// or as the program for a kind of file (assets/desktop/open-with.cmd).
bool is_opened_by_file_manager(const std::vector<std::string>& words) {
    if (!core::platform::has_own_console()) return false;
    std::error_code ignored;
    return words.size() < 2 || words[1] == "view" || std::filesystem::exists(words[1], ignored);
}

/// Opens the window. If that fails, the console stays until the message has been read.
int open_from_file_manager(std::vector<std::string> words) {
    if (words.size() < 2 || words[1] != "view") words.insert(words.begin() + 1, "view");
    const int status = run(words);
    if (core::platform::has_own_console()) {
        std::fputs("Press Enter to close this window.\n", stderr);
        std::getchar();
    }
    return status;
}

/// Fills tables of the locale that std::regex would fill from any thread, without a lock (GCC bug
/// 77704).
void fill_tables_of_locale() {
    const auto& characters = std::use_facet<std::ctype<char>>(std::locale());
    std::array<char, 256> all{}, same{};
    for (size_t i = 0; i < all.size(); ++i) all[i] = static_cast<char>(i);
    characters.narrow(all.data(), all.data() + all.size(), '\0', same.data());
    characters.widen(all.data(), all.data() + all.size(), same.data());
}

} // namespace

int main(int argc, char** argv) {
    try {
        fill_tables_of_locale();
        const std::vector<std::string> words = core::platform::begin_program(argc, argv);
        return is_opened_by_file_manager(words) ? open_from_file_manager(words) : run(words);
    } catch (const std::bad_alloc&) {
        std::fputs("feeler: not enough memory: use a larger mesh size\n", stderr);
    } catch (const std::exception& error) {
        std::fputs(fmt::format("feeler: internal error: {}\n", error.what()).c_str(), stderr);
    }
    return static_cast<int>(app::ExitCode::failed);
}
