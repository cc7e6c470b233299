#include <array>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <new>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <BRepMesh_IncrementalMesh.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Message_ProgressIndicator.hxx>
#include <Message_ProgressScope.hxx>
#include <Standard_Failure.hxx>
#include <TopTools_IndexedMapOfShape.hxx>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "core/base/text.h"
#include "core/cad/cad_message.h"
#include "core/cad/reader/document.h"
#include "core/cad/reader/solid_mesher.h"
#include "core/geom/mesh_file.h"

// Reads a CAD file with Open CASCADE and writes its solids as messages (cad_message.h) to standard
// output. A process of its own, because damaged files can make the library crash.
//
//     feeler-cad FILE step|iges|brep|freecad DEVIATION MOST_TRIANGLES SECONDS

namespace core::cad {

namespace {

/// Writes messages to the descriptor that was the standard output.
class Output {
public:
    explicit Output(int descriptor) : descriptor_(descriptor) {}

    void write(std::string_view bytes) const {
        while (!bytes.empty()) {
            const ssize_t count = ::write(descriptor_, bytes.data(), bytes.size());
            if (count <= 0) std::_Exit(1); // nobody listens
            bytes.remove_prefix(static_cast<size_t>(count));
        }
    }

private:
    int descriptor_;
};

/// Reports the progress of Open CASCADE in steps of one percent.
class Indicator : public Message_ProgressIndicator {
public:
    explicit Indicator(const Output& output) : output_(output) {}

    void Show(const Message_ProgressScope&, const Standard_Boolean) override {
        const int percent = static_cast<int>(100.0 * GetPosition());
        if (percent == shown_) return;
        shown_ = percent;
        output_.write(progress_message("reading", GetPosition()));
    }

private:
    const Output& output_;
    int shown_ = -1;
};

struct Arguments {
    std::string path;
    CadFormat format = CadFormat::step;
    MeshWish wish;
    unsigned long seconds = 0;
};

template <typename Number>
Number number_of(std::string_view text) {
    Number value{};
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

/// Limits what a damaged file can take: memory to that of the machine, time to that of the caller.
void limit_resources(unsigned long seconds) {
    const rlimit no_dump{0, 0}, time{seconds, seconds + 1};
    ::setrlimit(RLIMIT_CORE, &no_dump);
    ::setrlimit(RLIMIT_CPU, &time);
#ifndef __SANITIZE_ADDRESS__ // it reserves more than any machine has
    const auto memory = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES))
                        * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE));
    const rlimit space{memory, memory};
    ::setrlimit(RLIMIT_AS, &space);
#endif
    ::prctl(PR_SET_PDEATHSIG, SIGKILL); // ends with the program that started it
}

/// Keeps the standard output for messages, and silences what Open CASCADE prints.
int silenced_output() {
    const int output = ::dup(STDOUT_FILENO);
    const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
    ::dup2(nowhere, STDOUT_FILENO);
    ::dup2(nowhere, STDERR_FILENO);
    ::Message::DefaultMessenger()->ChangePrinters().Clear();
    return output;
}

/// The solid at its place.
CadSolid placed(const MeshedSolid& solid, const PlacedSolid& at) {
    CadSolid result;
    result.names = at.names;
    result.colour = at.colour;
    const double scale = std::abs(at.place.ScaleFactor());
    result.deviation = scale * solid.deviation;
    result.gap = scale * solid.gap;
    result.is_proven = solid.is_proven;
    result.mesh = solid.mesh;
    for (Vec3& vertex : result.mesh.vertices) {
        gp_XYZ p(vertex.x, vertex.y, vertex.z);
        at.place.Transforms(p);
        vertex = {p.X(), p.Y(), p.Z()};
    }
    if (at.place.IsNegative())
        for (Mesh::Corners& corners : result.mesh.triangles) std::swap(corners[1], corners[2]);
    return result;
}

/// Why a meshed solid cannot be used; empty if it can.
std::string why_unusable(const MeshedSolid& solid, const MeshWish& wish) {
    constexpr double largest_gap = 0.05; // of the size of a solid: it has no shape any more
    if (solid.gap > largest_gap * glm::length(solid.mesh.bounds().size()))
        return fmt::format("gaps of {:.3g} mm are between its faces: repair it in the CAD system",
                           solid.gap);
    if (solid.mesh.triangles.size() > wish.most_triangles)
        return fmt::format("the solids have too many triangles within {:g} mm of their surfaces: "
                           "allow a larger deviation (mesh_deviation)",
                           wish.deviation);
    return {};
}

/// Meshes each part once and writes it at all of its places.
///
/// `leaves_out`: a solid that cannot be used is left out; otherwise it is an error.
Result<bool> write_solids(const Document& document, MeshWish wish, bool leaves_out,
                          const Output& output) {
    TopTools_IndexedMapOfShape parts;
    std::vector<Result<MeshedSolid>> meshed;
    const double count = static_cast<double>(document.solids.size());
    for (size_t i = 0; i < document.solids.size(); ++i) {
        const PlacedSolid& at = document.solids[i];
        output.write(
            progress_message(fmt::format("meshing solid {} of {}", i + 1, document.solids.size()),
                             static_cast<double>(i) / count));
        const auto number = static_cast<size_t>(parts.Add(at.shape));
        if (number > meshed.size()) meshed.push_back(mesh_solid(at.shape, wish));
        const Result<MeshedSolid>& solid = meshed[number - 1];
        const std::string why = solid ? why_unusable(*solid, wish) : solid.error().message;
        if (!why.empty()) {
            const std::string what = fmt::format("{}: {}", at.names.back(), why);
            if (!leaves_out) return fail(ErrorCode::invalid_value, what);
            output.write(left_out_message({at.names, what}));
            continue;
        }
        wish.most_triangles -= solid->mesh.triangles.size();
        output.write(solid_message(placed(*solid, at)));
    }
    return true;
}

Result<bool> run(const Arguments& arguments, const Output& output) {
    const Handle(Indicator) indicator = new Indicator(output);
    FEELER_TRY(const Document document,
               read_document(arguments.path, arguments.format, arguments.wish.deviation,
                             indicator->Start()));
    for (const std::string& note : document.notes)
        output.write(text_message(MessageKind::note, note));
    for (const CadSurfaces& surfaces : document.left_out) output.write(left_out_message(surfaces));
    return write_solids(document, arguments.wish, arguments.format == CadFormat::freecad, output);
}

/// Runs and turns what Open CASCADE throws into an error.
Result<bool> guarded(const Arguments& arguments, const Output& output) {
    try {
        return run(arguments, output);
    } catch (const std::bad_alloc&) {
        return fail(ErrorCode::unsupported, "it needs more memory than this machine has");
    } catch (const Standard_Failure& failure) {
        return fail(ErrorCode::invalid_value,
                    fmt::format("Open CASCADE cannot read it ({}): it is damaged, or needs a "
                                "repair in the CAD system",
                                failure.DynamicType()->Name()));
    } catch (const std::exception&) {
        return fail(ErrorCode::invalid_value,
                    "Open CASCADE cannot read it: it is damaged, or needs a repair in the CAD "
                    "system");
    }
}

int read_file(const Arguments& arguments) {
    limit_resources(arguments.seconds);
    const Output output(silenced_output());
    const auto done = guarded(arguments, output);
    if (!done) output.write(text_message(MessageKind::error, done.error().message));
    output.write(end_message());
    std::_Exit(0); // takes no time to free what was read
}

} // namespace

} // namespace core::cad

int main(int count, char** words) {
    if (count != 6) return 2;
    core::cad::Arguments arguments;
    arguments.path = words[1];
    const auto format = core::find_named(core::cad::all_cad_formats, words[2]);
    if (!format) return 2;
    arguments.format = *format;
    arguments.wish.deviation = core::cad::number_of<double>(words[3]);
    arguments.wish.most_triangles = core::cad::number_of<size_t>(words[4]);
    arguments.seconds = core::cad::number_of<unsigned long>(words[5]);
    return core::cad::read_file(arguments);
}
