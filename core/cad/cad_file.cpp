#include "core/cad/cad_file.h"

#include <algorithm>
#include <cassert>
#include <deque>
#include <mutex>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/base/file_reads.h"
#include "core/base/platform.h"
#include "core/base/text.h"
#include "core/cad/cad_message.h"
#include "core/cad/reader_process.h"
#include "core/geom/mesh_file.h"

namespace core {

namespace {

thread_local const CadReadObserver* current_observer = nullptr;

constexpr size_t largest_cad_file = size_t{1} << 30U; // bytes
constexpr size_t most_triangles = 3'000'000;          // of a file: ten seconds of meshing

} // namespace

CadReadObserver::CadReadObserver(Callback callback)
    : callback_(std::move(callback)), older_(current_observer) {
    current_observer = this;
}

CadReadObserver::~CadReadObserver() { current_observer = older_; }

const CadReadObserver* CadReadObserver::current() { return current_observer; }

namespace {

/// The format that the extension of a path stands for.
std::optional<cad::CadFormat> format_of(const std::filesystem::path& path) {
    using enum cad::CadFormat;
    const std::string extension = lower_case(path.extension().generic_string());
    constexpr std::pair<std::string_view, cad::CadFormat> formats[] = {
        {".step", step}, {".stp", step},  {".p21", step}, {".iges", iges},
        {".igs", iges},  {".brep", brep}, {".brp", brep}, {".fcstd", freecad}};
    for (const auto& [known, format] : formats)
        if (extension == known) return format;
    return std::nullopt;
}

} // namespace

bool is_cad_file(const std::filesystem::path& path) { return format_of(path).has_value(); }

#ifdef FEELER_OPENCASCADE

std::string_view cad_library() { return "Open CASCADE " FEELER_OPENCASCADE; }

namespace {

struct ReaderProgram {
    std::mutex mutex;
    std::filesystem::path path;
};

ReaderProgram& reader_program() {
    static ReaderProgram program;
    return program;
}

/// Where the program is that reads CAD files: beside this one, or where an installation has it.
std::filesystem::path reader_path() {
    {
        const std::lock_guard lock(reader_program().mutex);
        if (!reader_program().path.empty()) return reader_program().path;
    }
    const std::filesystem::path folder = platform::program_path().parent_path();
    const std::filesystem::path installed = folder.parent_path() / "lib" / "feeler" / "feeler-cad";
    return platform::facts_of(folder / "feeler-cad") ? folder / "feeler-cad" : installed;
}

/// What can be said about the bytes of a STEP file before it is read.
Result<bool> check_step(std::string_view bytes) {
    constexpr size_t head = 4096;
    if (bytes.substr(0, head).find("ISO-10303-21") == std::string_view::npos)
        return fail(ErrorCode::syntax, "it is no STEP file: ISO-10303-21 is not at its start");
    constexpr std::string_view last_word = "END-ISO-10303-21";
    const size_t first_end = bytes.find(last_word);
    if (first_end == std::string_view::npos)
        return fail(ErrorCode::syntax,
                    "it is not complete: END-ISO-10303-21 is missing at its end; copy or export it "
                    "again");
    // What follows, such as signatures, is no part of the bodies.
    if (bytes.find("ISO-10303-21;", first_end + last_word.size() + 1) != std::string_view::npos)
        return fail(ErrorCode::syntax,
                    "it is several STEP files in one, of which only the first would be read: "
                    "separate them");
    return true;
}

/// What can be said about the bytes of an IGES file before it is read: lines of 80 columns, with
/// the section in column 73, end with section T.
Result<bool> check_iges(std::string_view bytes) {
    constexpr size_t section = 72;
    if (bytes.size() <= section || (bytes[section] != 'S' && bytes[section] != 'C'))
        return fail(ErrorCode::syntax, "it is no IGES file: section S is not at its start");
    const size_t last = bytes.find_last_not_of("\r\n \t\x1a");
    const size_t line = bytes.find_last_of("\r\n", last) + 1; // 0 if there is none
    if (line + section >= bytes.size() || bytes[line + section] != 'T')
        return fail(ErrorCode::syntax,
                    "it is not complete: section T is missing at its end; copy or export it again");
    return true;
}

/// What can be said about the bytes of a shape of Open CASCADE before it is read.
Result<bool> check_brep(std::string_view bytes) {
    constexpr size_t head = 64;
    if (bytes.substr(0, head).find("CASCADE Topology V") != std::string_view::npos) return true;
    return fail(ErrorCode::syntax, "it is no BREP file: \"CASCADE Topology\" is not at its start");
}

Result<bool> check_bytes(std::string_view bytes, cad::CadFormat format) {
    switch (format) {
    case cad::CadFormat::step:
        return check_step(bytes);
    case cad::CadFormat::iges:
        return check_iges(bytes);
    case cad::CadFormat::brep:
        return check_brep(bytes);
    case cad::CadFormat::freecad:
        break; // an archive, which is checked when it is opened
    }
    return true;
}

Result<std::string> cad_bytes(const std::filesystem::path& path, cad::CadFormat format) {
    if (const std::string why = why_no_file(path); !why.empty()) return fail(ErrorCode::io, why);
    std::optional<std::string> bytes = file_bytes(path, largest_cad_file);
    if (!bytes) return fail(ErrorCode::io, "it cannot be read");
    if (bytes->empty()) return fail(ErrorCode::syntax, "the file is empty");
    if (bytes->size() > largest_cad_file)
        return fail(ErrorCode::unsupported, "it has more than 1 GiB, the limit");
    if (bytes->starts_with("\xEF\xBB\xBF") || bytes->starts_with("\xFF\xFE"))
        return fail(ErrorCode::syntax, "it begins with a byte-order mark, so a text editor has "
                                       "saved it: export it again, or save it as ASCII");
    FEELER_TRY([[maybe_unused]] const bool is_plausible, check_bytes(*bytes, format));
    return *std::move(bytes);
}

/// Seconds that the reader may take: far more than an intact file needs.
unsigned seconds_for(size_t bytes, double deviation) {
    const double finer = std::max(1.0, default_cad_deviation / deviation);
    return 60 + static_cast<unsigned>(bytes >> 14U) + static_cast<unsigned>(30.0 * (finer - 1.0));
}

/// Takes the messages of the reader apart.
class Intake {
public:
    explicit Intake(std::string file) : file_(std::move(file)) {}

    bool take(std::string_view bytes) {
        received_ += bytes;
        std::string_view rest = received_;
        while (const auto message = cad::take_message(rest))
            if (!take(*message)) return false;
        received_.erase(0, received_.size() - rest.size());
        const CadReadObserver* observer = CadReadObserver::current();
        return !observer || observer->goes_on({file_, progress_.step, progress_.fraction});
    }

    Result<CadFile> result(cad::ReaderEnd end, unsigned seconds) &&;

private:
    bool take(const cad::Message& message);

    std::string file_, received_, error_;
    CadProgress progress_{{}, "reading", 0.0};
    CadFile read_;
    bool is_complete_ = false;
};

bool Intake::take(const cad::Message& message) {
    using Kind = cad::MessageKind;
    switch (message.kind) {
    case Kind::progress:
        progress_ = cad::progress_of(message.text).value_or(progress_);
        return true;
    case Kind::note:
        read_.notes.emplace_back(message.text);
        return true;
    case Kind::left_out:
        if (auto surfaces = cad::left_out_of(message.text)) {
            read_.left_out.push_back(*std::move(surfaces));
            return true;
        }
        return false;
    case Kind::error:
        error_ = message.text;
        return true;
    case Kind::solid:
        if (auto solid = cad::solid_of(message.text)) {
            read_.solids.push_back(*std::move(solid));
            return true;
        }
        return false;
    case Kind::end:
        is_complete_ = true;
        return true;
    }
    return false;
}

Result<CadFile> Intake::result(cad::ReaderEnd end, unsigned seconds) && {
    using End = cad::ReaderEnd;
    if (is_complete_ && error_.empty()) return std::move(read_);
    if (is_complete_) return fail(ErrorCode::invalid_value, error_);
    if (end == End::stopped) return fail(ErrorCode::io, "reading it was stopped");
    if (end == End::not_there)
        return fail(
            ErrorCode::unsupported,
            fmt::format("{}, which reads CAD files, cannot be started: install Feeler again, "
                        "or export the body as STL",
                        reader_path().generic_string()));
    if (end == End::no_library)
        return fail(ErrorCode::unsupported,
                    "the libraries of Open CASCADE are not installed: install the packages "
                    "libocct-data-exchange-7.6 and libocct-ocaf-7.6, or export the body as STL");
    if (end == End::out_of_time)
        return fail(
            ErrorCode::unsupported,
            fmt::format("it was not read within {} s of processor time: it is damaged, or "
                        "too large for this deviation; allow a larger one (mesh_deviation), "
                        "or export the body as STL",
                        seconds));
    return fail(ErrorCode::invalid_value,
                "Open CASCADE crashes when it reads it: it is damaged, or "
                "needs a repair in the CAD system");
}

/// The solids as checked bodies. What is repaired comes from the mesh, not from the file: two faces
/// can have a triangle each between three points of their edge, which are a shell of no volume.
Result<CadFile> checked(CadFile file) {
    std::vector<CadSolid> solids;
    for (CadSolid& solid : file.solids) {
        std::vector<std::string> repairs;
        auto mesh = checked_solid(std::move(solid.mesh), repairs);
        if (mesh) {
            solid.mesh = *std::move(mesh);
            solids.push_back(std::move(solid));
            continue;
        }
        std::string what = fmt::format("{}: {}", solid.name(), mesh.error().message);
        if (!file.bodies_are_apart) return fail(mesh.error().code, std::move(what));
        file.left_out.push_back({std::move(solid.names), std::move(what)});
    }
    file.solids = std::move(solids);
    return file;
}

Result<CadFile> read_fresh(const std::filesystem::path& path, cad::CadFormat format,
                           double deviation, size_t size) {
    const std::string name = path.generic_string();
    const unsigned seconds = seconds_for(size, deviation);
    Intake intake(name);
    const cad::ReaderEnd end =
        cad::run_reader({reader_path().string(), path.string(), std::string(name_of(format)),
                         fmt::format("{}", deviation), fmt::format("{}", most_triangles),
                         fmt::format("{}", seconds)},
                        [&](std::string_view bytes) { return intake.take(bytes); });
    FEELER_TRY(CadFile file, std::move(intake).result(end, seconds));
    file.bodies_are_apart = format == cad::CadFormat::freecad;
    return checked(std::move(file));
}

/// A file that was read, kept because a set-up is read again after each change.
struct KeptFile {
    std::string bytes;
    cad::CadFormat format{};
    double deviation = 0.0;
    std::shared_ptr<const CadFile> file;
};

struct KeptFiles {
    std::mutex mutex;
    std::deque<KeptFile> files; // the last used first
};

KeptFiles& kept_files() {
    static KeptFiles kept;
    return kept;
}

std::shared_ptr<const CadFile> find_kept(const KeptFile& wanted) {
    KeptFiles& kept = kept_files();
    const std::lock_guard lock(kept.mutex);
    const auto same = [&](const KeptFile& file) {
        return file.deviation == wanted.deviation && file.format == wanted.format
               && file.bytes == wanted.bytes;
    };
    const auto found = std::find_if(kept.files.begin(), kept.files.end(), same);
    if (found == kept.files.end()) return {};
    std::rotate(kept.files.begin(), found, found + 1);
    return kept.files.front().file;
}

size_t triangle_bytes(const CadFile& file) {
    size_t bytes = 0;
    for (const CadSolid& solid : file.solids)
        bytes += solid.mesh.triangles.size() * sizeof(Mesh::Corners)
                 + solid.mesh.vertices.size() * sizeof(Vec3);
    return bytes;
}

void keep(KeptFile file) {
    constexpr size_t most_files = 8, most_bytes = size_t{512} << 20U; // with triangles
    KeptFiles& kept = kept_files();
    const std::lock_guard lock(kept.mutex);
    kept.files.push_front(std::move(file));
    size_t count = 0, bytes = 0;
    std::erase_if(kept.files, [&](const KeptFile& one) {
        bytes += one.bytes.size() + triangle_bytes(*one.file);
        return ++count > most_files || bytes > most_bytes;
    });
}

Result<std::shared_ptr<const CadFile>> read_or_kept(const std::filesystem::path& path,
                                                    double deviation) {
    const cad::CadFormat format = *format_of(path);
    FEELER_TRY(std::string bytes, cad_bytes(path, format));
    KeptFile wanted{std::move(bytes), format, deviation, {}};
    if (auto file = find_kept(wanted)) return file;
    FEELER_TRY(CadFile file, read_fresh(path, format, deviation, wanted.bytes.size()));
    // The reader opened the file once more.
    if (file_bytes(path, largest_cad_file) != wanted.bytes)
        return fail(ErrorCode::io, "it changed while it was read: try again");
    wanted.file = std::make_shared<const CadFile>(std::move(file));
    keep(wanted);
    return wanted.file;
}

} // namespace

bool has_cad_reader() { return platform::facts_of(reader_path()).has_value(); }

void set_cad_reader(const std::filesystem::path& program) {
    const std::lock_guard lock(reader_program().mutex);
    reader_program().path = program;
}

#else

std::string_view cad_library() { return {}; }

bool has_cad_reader() { return false; }

void set_cad_reader(const std::filesystem::path&) {}

namespace {

Result<std::shared_ptr<const CadFile>> read_or_kept(const std::filesystem::path&, double) {
    return fail(
        ErrorCode::unsupported,
        "this feeler was built without Open CASCADE, so it cannot read CAD files: export the "
        "body as STL, or build Feeler with the packages of .ci/packages/cad.txt installed");
}

} // namespace

#endif

Result<std::shared_ptr<const CadFile>> read_cad(const std::filesystem::path& path,
                                                double deviation) {
    assert(is_cad_file(path));
    assert(deviation >= least_cad_deviation && deviation <= largest_cad_deviation);
    return read_or_kept(path, deviation).map_error([&](const Error& error) {
        return in_file(error, path.generic_string());
    });
}

namespace {

bool is_in(const std::vector<std::string>& names, const std::string& name) {
    return name.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

bool is_own_name(const CadFile& file, const std::string& name) {
    return std::any_of(file.solids.begin(), file.solids.end(),
                       [&](const CadSolid& solid) { return solid.name() == name; });
}

/// The names of a file, not more than fit in a message.
std::string names_text(const CadFile& file) {
    constexpr size_t most = 30;
    std::vector<std::string> names;
    for (CadName& each : names_of(file)) {
        for (char& c : each.name)
            if (static_cast<unsigned char>(c) < ' ') c = ' ';
        names.push_back(std::move(each.name));
    }
    if (names.empty()) return "none";
    const size_t count = names.size();
    names.resize(std::min(count, most));
    return fmt::format("\"{}\"{}", fmt::join(names, "\", \""),
                       count > most ? fmt::format(" and {} more", count - most) : "");
}

void append(Mesh& mesh, const Mesh& other) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
    for (const auto& [a, b, c] : other.triangles)
        mesh.triangles.push_back({first + a, first + b, first + c});
}

} // namespace

std::vector<std::string> remarks_on(const CadFile& file) {
    std::vector<std::string> remarks = file.notes;
    if (file.bodies_are_apart) return remarks; // what is left out belongs to other bodies
    for (const CadSurfaces& surfaces : file.left_out)
        remarks.push_back(surfaces.what + "; they are left out");
    return remarks;
}

std::vector<CadName> names_of(const CadFile& file) {
    std::vector<CadName> names;
    std::unordered_map<std::string_view, size_t> at;
    for (const CadSolid& solid : file.solids)
        for (const std::string& name : solid.names) {
            const auto [found, is_new] = at.emplace(name, names.size());
            if (is_new) names.push_back({name, {}});
            if (&name == &solid.names.back()) names[found->second].colour = solid.colour;
        }
    return names;
}

Result<CadBody> body_of(const CadFile& file, const std::string& name) {
    if (name.empty() && file.bodies_are_apart && file.solids.size() > 1)
        return fail(ErrorCode::missing_value,
                    fmt::format("it has several bodies: name the one that is meant (solid = ...): "
                                "{}",
                                names_text(file)));
    std::vector<std::string> missing;
    // A FreeCAD object has the name of its solid even if more of it is not read.
    const bool is_whole = !file.bodies_are_apart && is_own_name(file, name);
    for (const CadSurfaces& surfaces : file.left_out)
        if (!is_whole && is_in(surfaces.names, name)) missing.push_back(surfaces.what);
    if (!missing.empty() && file.bodies_are_apart)
        return fail(ErrorCode::invalid_value,
                    fmt::format("not all of it can be read: {}. There are {}",
                                fmt::join(missing, "; "), names_text(file)));
    if (!missing.empty())
        return fail(ErrorCode::invalid_value,
                    fmt::format("beside solids it has surfaces that enclose none, and could be "
                                "part of the body: {}. Close them in the CAD system; or name each "
                                "solid of the body: {}",
                                fmt::join(missing, "; "), names_text(file)));
    CadBody body;
    for (const CadSolid& solid : file.solids) {
        if (!is_in(solid.names, name)) continue;
        append(body.mesh, solid.mesh);
        body.deviation = std::max(body.deviation, solid.deviation);
        body.gap = std::max(body.gap, solid.gap);
        body.is_proven = body.is_proven && solid.is_proven;
        ++body.solids;
    }
    if (body.solids > 0) return body;
    return fail(ErrorCode::invalid_value,
                fmt::format("no solid has the name \"{}\"; there are {}", name, names_text(file)));
}

} // namespace core
