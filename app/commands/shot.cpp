#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "app/check/check_job.h"
#include "app/commands/commands.h"
#include "app/commands/output.h"
#include "app/commands/program_arguments.h"
#include "app/commands/read_files.h"
#include "app/commands/suggestion.h"
#include "app/view/model/navigation.h"
#include "app/view/ui/window.h"
#include "core/base/platform.h"
#include "core/sim/verdict.h"
#include "render/image.h"

namespace app {

constexpr int frames_per_second = 25;

/// Joins pictures to a film with ffmpeg. If the output is a .png or ffmpeg is missing, writes
/// numbered pictures instead: `name-0001.png` and so on.
class FilmWriter {
public:
    /// Errors: ffmpeg exists but cannot write such a file; no folder for the pictures.
    static core::Result<std::unique_ptr<FilmWriter>> open(const std::string& output);
    FilmWriter(const FilmWriter&) = delete;
    FilmWriter& operator=(const FilmWriter&) = delete;
    ~FilmWriter();

    /// Errors: the picture cannot be written.
    core::Result<void> add(const render::Image& image);

    /// Makes the film. An existing file under its name stays until the film is complete. Returns
    /// the names of the pictures if they are the result; empty for a film.
    ///
    /// Errors: ffmpeg could not write the film.
    core::Result<std::string> finish();

private:
    explicit FilmWriter(const std::string& output) : output_(output) {}
    core::Error refusal() const;
    /// Path that ffmpeg writes to, with the extension that selects the format.
    std::string unfinished() const;
    std::string picture(size_t number) const;

    std::filesystem::path output_;
    std::filesystem::path folder_; // for the pictures of a film; empty if they are the result
    size_t count_ = 0;
};

namespace {

bool run_ffmpeg(std::vector<std::string> words) {
    words.insert(words.begin(), "ffmpeg");
    return core::platform::run_quietly(words) == 0;
}

bool has_ffmpeg() { return run_ffmpeg({"-loglevel", "quiet", "-version"}); }

/// Whether ffmpeg can write a file of this name.
bool can_write(const std::string& output) {
    return run_ffmpeg({"-y", "-loglevel", "quiet", "-f", "lavfi", "-i",
                       "color=size=64x64:duration=0.1", "-pix_fmt", "yuv420p", output});
}

bool join(const std::string& pattern, const std::string& output) {
    return run_ffmpeg({"-y", "-loglevel", "error", "-framerate", std::to_string(frames_per_second),
                       "-i", pattern, "-pix_fmt", "yuv420p", "-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                       output});
}

} // namespace

core::Result<std::unique_ptr<FilmWriter>> FilmWriter::open(const std::string& output) {
    std::unique_ptr<FilmWriter> writer(new FilmWriter(output));
    if (writer->output_.extension() == ".png" || !has_ffmpeg()) return writer;
    if (!can_write(writer->unfinished())) {
        std::error_code ignored;
        std::filesystem::remove(writer->unfinished(), ignored);
        return tl::unexpected(writer->refusal());
    }
    writer->folder_ = core::platform::make_temporary_folder("feeler-film");
    if (writer->folder_.empty())
        return core::fail(core::ErrorCode::io, "cannot create a folder for the film's pictures");
    return writer;
}

FilmWriter::~FilmWriter() {
    std::error_code ignored;
    if (folder_.empty()) return;
    std::filesystem::remove(unfinished(), ignored);
    std::filesystem::remove_all(folder_, ignored);
}

core::Error FilmWriter::refusal() const {
    return {core::ErrorCode::io,
            {},
            fmt::format("ffmpeg cannot write the film {}: choose a writable file of a type "
                        "that ffmpeg supports, such as .mp4",
                        output_.generic_string())};
}

std::string FilmWriter::unfinished() const {
    return (output_.parent_path() / (".unfinished-" + output_.filename().generic_string()))
        .generic_string();
}

std::string FilmWriter::picture(size_t number) const {
    const std::string name = fmt::format("{}-{:04}.png", output_.stem().generic_string(), number);
    return (folder_.empty() ? output_.parent_path() / name
                            : folder_ / fmt::format("{:04}.png", number))
        .generic_string();
}

core::Result<void> FilmWriter::add(const render::Image& image) {
    return render::write_png(image, picture(++count_));
}

core::Result<std::string> FilmWriter::finish() {
    if (folder_.empty()) return fmt::format("{} to {}", picture(1), picture(count_));
    if (!join((folder_ / "%04d.png").generic_string(), unfinished()))
        return tl::unexpected(refusal());
    std::error_code failed;
    std::filesystem::rename(unfinished(), output_, failed);
    if (failed) return tl::unexpected(refusal());
    return std::string();
}

namespace {

using viewer::BlockRow;
using viewer::OffscreenViewer;
using viewer::ViewModel;

constexpr size_t most_prints = 60;  // of a sheet
constexpr size_t most_frames = 500; // of a film: 20 seconds

struct ShotOptions {
    CheckArguments what;
    DeviceArguments device;
    std::string output, view = "iso", theme = "dark", size = "1440x900";
    std::optional<size_t> block, finding, from, to;
    bool worst = false, sheet = false, no_ui = false;
};

core::Result<render::Viewport> size_in(const std::string& text) {
    render::Viewport size;
    char rest = 0;
    if (std::sscanf(text.c_str(), "%dx%d%c", &size.width, &size.height, &rest) == 2
        && size.width >= 64 && size.height >= 64 && size.width <= 8192 && size.height <= 8192)
        return size;
    return core::fail(
        core::ErrorCode::invalid_value,
        fmt::format("'{}' is not a size: write WIDTHxHEIGHT, 64 to 8192 pixels", text));
}

viewer::ShotView view_named(const std::string& name) {
    if (name == "top") return viewer::ShotView::top;
    if (name == "front") return viewer::ShotView::front;
    if (name == "witness") return viewer::ShotView::witness;
    return viewer::ShotView::iso;
}

core::Error no_such(const std::string& what) { return {core::ErrorCode::invalid_value, {}, what}; }

std::string block_numbers(const ViewModel& model) {
    return fmt::format("the blocks of this program are 0 to {}, as in the reports of check",
                       model.rows.size() - 1);
}

core::Result<size_t> chosen_block(const ShotOptions& options, const ViewModel& model) {
    if (options.block) {
        if (*options.block < model.rows.size()) return *options.block;
        return tl::unexpected(no_such("--block: " + block_numbers(model)));
    }
    if (!options.finding) return viewer::worst_block(model);
    const size_t number = *options.finding;
    if (number < 1 || number > model.findings.size())
        return tl::unexpected(
            no_such(fmt::format("--finding: there are {} findings", model.findings.size())));
    const core::Finding& finding = model.findings[number - 1];
    if (!finding.block)
        return tl::unexpected(
            no_such(fmt::format("--finding: {} is about the program as a whole", finding.rule)));
    return core::value_of(*finding.block);
}

core::Result<void> shoot_block(const ShotOptions& options, const render::Viewport& size,
                               OffscreenViewer& offscreen) {
    ViewModel& model = offscreen.model;
    FEELER_TRY(const size_t block, chosen_block(options, model));
    if (options.block)
        viewer::go_to(model, block);
    else if (options.finding)
        viewer::go_to_witness(model, block, model.findings[*options.finding - 1].pair);
    else
        viewer::go_to_witness(model, block);
    offscreen.settle();
    offscreen.set_view(view_named(options.view), size);
    FEELER_TRY(const render::Image image, offscreen.picture(size, !options.no_ui));
    return render::write_png(image, options.output);
}

/// What a print of a sheet shows: a block, a pair of bodies (without names, the deciding one), and
/// the findings about them.
struct SheetPrint {
    size_t block = 0;
    viewer::BodyNames pair;
    std::vector<size_t> findings; // indices
};

/// The prints of all findings about blocks, in the order of the blocks.
std::vector<SheetPrint> prints_of_findings(const ViewModel& model) {
    std::vector<SheetPrint> prints;
    for (size_t i = 0; i < model.findings.size(); ++i) {
        const core::Finding& finding = model.findings[i];
        if (!finding.block || core::value_of(*finding.block) >= model.rows.size()) continue;
        const size_t block = core::value_of(*finding.block);
        const auto same = std::find_if(prints.begin(), prints.end(), [&](const SheetPrint& print) {
            return print.block == block && print.pair == finding.pair;
        });
        if (same != prints.end())
            same->findings.push_back(i);
        else
            prints.push_back({block, finding.pair, {i}});
    }
    std::stable_sort(prints.begin(), prints.end(),
                     [](const auto& a, const auto& b) { return a.block < b.block; });
    return prints;
}

std::string caption_of(const ViewModel& model, const SheetPrint& print) {
    const BlockRow& row = model.rows[print.block];
    std::string text;
    for (const size_t i : print.findings)
        text += fmt::format("{}{} {}", text.empty() ? "" : ", ", i + 1, model.findings[i].rule);
    text += fmt::format("  \xC2\xB7  block {}, line {}", print.block, row.line);
    const viewer::BodyNames decides = {row.part, row.body};
    if (!print.pair[0].empty() && print.pair != decides)
        return text + fmt::format("  \xC2\xB7  {} \xE2\x80\x93 {}", print.pair[0], print.pair[1]);
    if (row.has_pair())
        text += fmt::format("  \xC2\xB7  {} mm  {} \xE2\x80\x93 {}",
                            core::clearance_at_least(*row.lower, 2), row.part, row.body);
    return text;
}

core::Result<void> shoot_sheet(const ShotOptions& options, OffscreenViewer& offscreen) {
    const render::Viewport size{460, 330};
    std::vector<OffscreenViewer::Print> prints;
    const std::vector<SheetPrint> wanted = prints_of_findings(offscreen.model);
    for (const SheetPrint& print : wanted) {
        if (prints.size() == most_prints) break;
        viewer::go_to_witness(offscreen.model, print.block, print.pair);
        offscreen.settle();
        offscreen.set_view(viewer::ShotView::witness, size);
        FEELER_TRY(render::Image image, offscreen.picture(size, false));
        prints.push_back({std::move(image), caption_of(offscreen.model, print)});
    }
    if (wanted.size() > prints.size())
        print_note(fmt::format("feeler: the sheet has the first {} of {} pictures of findings\n",
                               prints.size(), wanted.size()));
    if (prints.empty())
        return core::fail(core::ErrorCode::missing_value, "--sheet: no finding is about a block");
    const size_t columns = prints.size() < 4 ? prints.size() : prints.size() < 9 ? 2 : 3;
    FEELER_TRY(const render::Image image, offscreen.sheet(prints, columns));
    return render::write_png(image, options.output);
}

core::Result<void> shoot_film(const ShotOptions& options, const render::Viewport& size,
                              OffscreenViewer& offscreen) {
    ViewModel& model = offscreen.model;
    const size_t from = options.from.value_or(0), to = options.to.value_or(model.rows.size() - 1);
    if (to >= model.rows.size() || from >= model.rows.size())
        return tl::unexpected(no_such("--from, --to: " + block_numbers(model)));
    if (to < from)
        return tl::unexpected(no_such(fmt::format("--from {} is after --to {}", from, to)));
    const BlockRow& last = model.rows[to];
    const double length = last.time + last.duration - model.rows[from].time;
    const size_t count =
        std::clamp<size_t>(static_cast<size_t>(length * frames_per_second), 2, most_frames);
    viewer::go_to(model, from, model.rows[from].duration > 0.0 ? 0.0 : 1.0);
    model.playback.running = true;
    model.playback.speed = 1.0;
    FEELER_TRY(const auto film, FilmWriter::open(options.output));
    for (size_t i = 0; i < count; ++i) {
        offscreen.settle();
        if (i == 0) offscreen.set_view(view_named(options.view), size);
        FEELER_TRY(const render::Image image, offscreen.picture(size, !options.no_ui));
        if (const auto written = film->add(image); !written) return written;
        viewer::play(model, length / static_cast<double>(count - 1));
    }
    FEELER_TRY(const std::string pictures, film->finish());
    if (!pictures.empty() && std::filesystem::path(options.output).extension() != ".png")
        print_note(
            fmt::format("feeler: a film needs ffmpeg; wrote pictures instead: {}\n", pictures));
    return {};
}

/// A picture may replace only a picture: any other file may be needed, such as a mesh.
core::Result<void> check_replaced(const std::string& output) {
    constexpr std::string_view signature = "\x89PNG";
    std::error_code ignored;
    if (!std::filesystem::is_regular_file(output, ignored)) return {};
    std::string bytes(signature.size(), '\0');
    std::ifstream(std::filesystem::path(output), std::ios::binary)
        .read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    if (bytes == signature || std::filesystem::file_size(output, ignored) == 0) return {};
    return tl::unexpected<core::Error>({core::ErrorCode::invalid_value,
                                        {},
                                        "exists and is not a picture: choose another file for -o",
                                        output});
}

core::Result<void> shoot(const ShotOptions& options) {
    ReadFiles read;
    FEELER_TRY(const CheckJob job, job_of(options.what));
    FEELER_TRY(const render::Viewport size, size_in(options.size));
    for (const std::string& path : {job.program, job.setup, options.device.file}) read.add(path);
    if (auto safe = read.check(options.output); !safe) return safe;
    if (!options.from && !options.to)
        if (auto safe = check_replaced(options.output); !safe) return safe;
    const auto theme =
        options.theme == "light" ? render::ColorScheme::light : render::ColorScheme::dark;
    FEELER_TRY(const auto offscreen, OffscreenViewer::make(theme, 1.0));
    if (const auto opened = offscreen->open(job); !opened) return opened;
    if (!offscreen->model.has_rows() && offscreen->model.stopped)
        return tl::unexpected(*offscreen->model.stopped);
    if (!offscreen->model.has_rows())
        return core::fail(core::ErrorCode::missing_value, "the program executes no block");
    if (options.device.shown)
        if (const auto run = offscreen->run_device(options.device.file); !run) return run;
    if (options.sheet) return shoot_sheet(options, *offscreen);
    if (options.from || options.to) return shoot_film(options, size, *offscreen);
    return shoot_block(options, size, *offscreen);
}

/// Options that select what is shown; they exclude each other.
void add_subject(CLI::App& command, ShotOptions& options) {
    auto* block =
        command.add_option("--block", options.block,
                           "Show the end of this block, numbered as in the reports of check");
    auto* worst = command.add_flag("--worst", options.worst,
                                   "Show the block with the least margin (default)");
    auto* finding = command.add_option("--finding", options.finding,
                                       "Show the block of this finding, numbered from 1");
    auto* sheet = command.add_flag("--sheet", options.sheet, "Show all findings on one sheet");
    auto* from =
        command.add_option("--from", options.from, "Make a film that begins with this block");
    auto* to = command.add_option("--to", options.to, "Last block of the film");
    for (CLI::Option* one : {block, worst, finding, sheet})
        for (CLI::Option* other : {block, worst, finding, sheet, from, to})
            if (one != other) one->excludes(other);
}

void add_view_options(CLI::App& command, ShotOptions& options) {
    command.add_option("--size", options.size, "Width and height in pixels")->capture_default_str();
    command.add_option("--view", options.view, "Direction of view")
        ->check(one_of({"iso", "top", "front", "witness"}))
        ->capture_default_str();
    command.add_flag("--no-ui", options.no_ui, "Only the 3D view, without panels");
    command.add_option("--theme", options.theme, "Colours")
        ->check(one_of({"dark", "light"}))
        ->capture_default_str();
}

} // namespace

void add_shot(CLI::App& cli, ExitCode& exit_code) {
    const auto options = std::make_shared<ShotOptions>();
    CLI::App& command = *cli.add_subcommand("shot", "Take pictures of a program, without a window");
    add_check_arguments(command, options->what)->required();
    add_subject(command, *options);
    add_path(command, "-o,--output", options->output,
             "Picture (.png), or film (.mp4 or another type that ffmpeg writes; without "
             "ffmpeg, numbered pictures)")
        ->required();
    add_view_options(command, *options);
    add_device_arguments(command, options->device);
    command.callback([options, &exit_code] {
        const auto done = shoot(*options);
        exit_code = done ? ExitCode::clear : failed(done.error());
    });
}

} // namespace app
