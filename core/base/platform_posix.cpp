#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <span>
#include <sstream>
#include <utility>

#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <link.h>
#include <malloc.h>
#include <spawn.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/shm.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/base/platform.h"

namespace core::platform {

std::vector<std::string> begin_program(int argc, char** argv) { return {argv, argv + argc}; }

bool has_own_console() { return false; }
void close_own_console() {}

std::filesystem::path program_path() {
    std::error_code failure;
    std::filesystem::path path = std::filesystem::read_symlink("/proc/self/exe", failure);
    return failure ? std::filesystem::path() : path;
}

namespace {

std::string build_id_in(std::span<const char> notes) {
    while (notes.size() >= sizeof(ElfW(Nhdr))) {
        ElfW(Nhdr) note;
        std::copy_n(notes.data(), sizeof note, reinterpret_cast<char*>(&note));
        const size_t name = sizeof note;
        const size_t description = name + (note.n_namesz + 3) / 4 * 4;
        const size_t next = description + (note.n_descsz + 3) / 4 * 4;
        if (next > notes.size()) return {};
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4) {
            std::string id;
            for (const char byte : notes.subspan(description, note.n_descsz))
                id += fmt::format("{:02x}", static_cast<unsigned char>(byte));
            return id;
        }
        notes = notes.subspan(next);
    }
    return {};
}

/// Called for each loaded file; the first is the program itself.
int take_build_id(dl_phdr_info* info, size_t, void* taken) {
    for (const ElfW(Phdr) & part : std::span(info->dlpi_phdr, info->dlpi_phnum)) {
        if (part.p_type != PT_NOTE) continue;
        const auto* notes = reinterpret_cast<const char*>(info->dlpi_addr + part.p_vaddr);
        std::string& id = *static_cast<std::string*>(taken);
        if (id.empty()) id = build_id_in({notes, part.p_memsz});
    }
    return 1; // no further file
}

} // namespace

std::string build_id() {
    std::string id;
    dl_iterate_phdr(&take_build_id, &id);
    return id;
}

bool is_running(unsigned process) {
    return ::kill(static_cast<pid_t>(process), 0) == 0 || errno == EPERM;
}

unsigned process_id() { return static_cast<unsigned>(::getpid()); }

std::string environment_variable(const char* name) {
    const char* value = std::getenv(name);
    return value ? value : "";
}

namespace {

/// A folder from an environment variable or below the home folder.
std::filesystem::path user_folder(const char* variable, const char* below_home) {
    const std::filesystem::path stated = environment_variable(variable);
    if (stated.is_absolute()) return stated;
    const std::string home = environment_variable("HOME");
    return home.empty() ? std::filesystem::path() : std::filesystem::path(home) / below_home;
}

} // namespace

std::filesystem::path settings_folder() { return user_folder("XDG_CONFIG_HOME", ".config"); }
std::filesystem::path state_folder() { return user_folder("XDG_STATE_HOME", ".local/state"); }
std::filesystem::path pictures_folder() { return user_folder("XDG_PICTURES_DIR", "Pictures"); }
std::filesystem::path documents_folder() { return user_folder("XDG_DOCUMENTS_DIR", "Documents"); }
std::filesystem::path home_folder() { return environment_variable("HOME"); }

namespace {

/// A path as /proc writes it: blanks and the like are three octal digits after a backslash.
std::string without_escapes(const std::string& text) {
    const auto is_digit = [&](size_t at) {
        return at < text.size() && text[at] >= '0' && text[at] <= '7';
    };
    std::string plain;
    for (size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '\\' || !is_digit(i + 1) || !is_digit(i + 2) || !is_digit(i + 3)) {
            plain += text[i];
            continue;
        }
        const int code = 64 * (text[i + 1] - '0') + 8 * (text[i + 2] - '0') + (text[i + 3] - '0');
        plain += static_cast<char>(code);
        i += 3;
    }
    return plain;
}

} // namespace

std::vector<std::filesystem::path> drive_folders() {
    std::vector<std::filesystem::path> found;
    std::ifstream mounts("/proc/self/mounts");
    for (std::string line; std::getline(mounts, line);) {
        std::istringstream words(line);
        std::string device, target;
        words >> device >> target;
        target = without_escapes(target);
        for (const char* below : {"/media/", "/run/media/", "/mnt/"})
            if (target.starts_with(below)) found.emplace_back(target);
    }
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
}

double physical_memory() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGE_SIZE);
    return pages > 0 && size > 0 ? static_cast<double>(pages) * static_cast<double>(size) : 0.0;
}

void release_free_memory() { ::malloc_trim(0); }

double thread_cpu_seconds() {
    timespec now{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

int64_t steady_milliseconds() {
    timespec now{};
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return int64_t{1000} * now.tv_sec + now.tv_nsec / 1'000'000;
}

void catch_interrupts(Interrupts which, void (*note)(int)) {
    std::signal(SIGINT, note);
    if (which == Interrupts::keys) return;
    std::signal(SIGTERM, note);
    // SIGHUP stays ignored under nohup: the program is to outlive its terminal.
    if (std::signal(SIGHUP, note) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
}

void end_by_interrupt(int which) {
    std::signal(which, SIG_DFL);
    std::raise(which);
}

void ignore_broken_pipes() { std::signal(SIGPIPE, SIG_IGN); }

std::optional<int> run_quietly(const std::vector<std::string>& words) {
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int failed =
        ::posix_spawnp(&child, arguments[0], &files, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    int status = 0;
    if (failed != 0 || ::waitpid(child, &status, 0) != child || !WIFEXITED(status))
        return std::nullopt;
    return WEXITSTATUS(status);
}

void* shared_memory(uint32_t key, size_t bytes) {
    const int id = ::shmget(static_cast<key_t>(key), bytes, 0);
    if (id < 0) return nullptr;
    void* const memory = ::shmat(id, nullptr, 0);
    return memory == reinterpret_cast<void*>(-1) ? nullptr : memory;
}

std::optional<Companion> Companion::start(const std::vector<std::string>& words) {
    std::array<int, 2> input{}, output{};
    if (::pipe2(input.data(), O_CLOEXEC) != 0) return {};
    if (::pipe2(output.data(), O_CLOEXEC) != 0) {
        ::close(input[0]);
        ::close(input[1]);
        return {};
    }
    std::vector<char*> arguments;
    for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_adddup2(&files, input[0], STDIN_FILENO);
    ::posix_spawn_file_actions_adddup2(&files, output[1], STDOUT_FILENO);
    pid_t process = -1;
    const int failed =
        ::posix_spawnp(&process, arguments[0], &files, nullptr, arguments.data(), environ);
    ::posix_spawn_file_actions_destroy(&files);
    ::close(input[0]);
    ::close(output[1]);
    for (const int end : {input[1], output[0]})
        ::fcntl(end, F_SETFL, ::fcntl(end, F_GETFL) | O_NONBLOCK);
    Companion started;
    started.process_ = failed == 0 ? process : -1;
    started.input_ = input[1];
    started.output_ = output[0];
    started.is_open_ = failed == 0;
    if (failed != 0) return {};
    return started;
}

Companion::Companion(Companion&& other) noexcept { *this = std::move(other); }

Companion& Companion::operator=(Companion&& other) noexcept {
    std::swap(process_, other.process_);
    std::swap(input_, other.input_);
    std::swap(output_, other.output_);
    std::swap(is_open_, other.is_open_);
    return *this;
}

Companion::~Companion() { end(); }

void Companion::end() {
    if (input_ >= 0) ::close(input_);
    if (output_ >= 0) ::close(output_);
    if (process_ > 0) {
        ::kill(process_, SIGTERM);
        ::waitpid(process_, nullptr, 0);
    }
}

bool Companion::write(const std::string& text) {
    return is_open_
           && ::write(input_, text.data(), text.size()) == static_cast<ssize_t>(text.size());
}

std::string Companion::read() {
    std::string text;
    std::array<char, 4096> block{};
    while (is_open_) {
        const ssize_t count = ::read(output_, block.data(), block.size());
        if (count < 0 && (errno == EAGAIN || errno == EINTR)) break;
        is_open_ = count > 0;
        if (count > 0) text.append(block.data(), static_cast<size_t>(count));
    }
    return text;
}

bool is_terminal(std::FILE* stream) { return ::isatty(::fileno(stream)) == 1; }

std::optional<size_t> terminal_width(std::FILE* stream) {
    winsize size{};
    if (::ioctl(::fileno(stream), TIOCGWINSZ, &size) != 0) return std::nullopt;
    return size.ws_col;
}

namespace {

int64_t nanoseconds(const timespec& time) {
    return int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

} // namespace

std::optional<FileFacts> facts_of(const std::filesystem::path& path) {
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return std::nullopt;
    return FileFacts{.is_folder = S_ISDIR(status.st_mode),
                     .is_file = S_ISREG(status.st_mode),
                     .device = static_cast<uint64_t>(status.st_dev),
                     .number = static_cast<uint64_t>(status.st_ino),
                     .size = static_cast<uint64_t>(status.st_size),
                     .modified = nanoseconds(status.st_mtim),
                     .changed = nanoseconds(status.st_ctim)};
}

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code ignored; // a missing file equals no other
    return std::filesystem::equivalent(a, b, ignored);
}

bool is_device(const std::filesystem::path& path) {
    std::error_code ignored;
    return std::filesystem::is_character_file(path, ignored);
}

std::FILE* open_file(const std::filesystem::path& path, const char* mode) {
    return std::fopen(path.c_str(), mode);
}

bool write_through(std::FILE* file) { return ::fsync(::fileno(file)) == 0; }

void take_permissions(const std::filesystem::path& fresh, const std::filesystem::path& old) {
    struct stat was {};
    if (::stat(old.c_str(), &was) != 0) return;
    // Without the right to do this, the file stays one of the user, as after any other saving.
    const bool has_group = ::chown(fresh.c_str(), static_cast<uid_t>(-1), was.st_gid) == 0;
    const mode_t mode = was.st_mode & (has_group ? 07777U : 07707U); // not for another group
    [[maybe_unused]] const int done = ::chmod(fresh.c_str(), mode);
}

std::error_code replace_file(const std::filesystem::path& fresh, const std::filesystem::path& old) {
    std::error_code failure;
    std::filesystem::rename(fresh, old, failure);
    return failure;
}

std::filesystem::path make_temporary_folder(const char* name) {
    std::error_code failure;
    std::string folder =
        (std::filesystem::temp_directory_path(failure) / fmt::format("{}-XXXXXX", name))
            .generic_string();
    if (failure || !::mkdtemp(folder.data())) return {};
    return folder;
}

std::string with_slashes(std::string path) { return path; }

std::filesystem::path in_stored_case(const std::filesystem::path& path) { return path; }

char list_separator() { return ':'; }

std::string case_folded(const std::string& name) { return name; }

std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& failure) {
    std::vector<std::string> names;
    for (std::filesystem::directory_iterator at(folder, failure), end; !failure && at != end;
         at.increment(failure))
        names.push_back(at->path().filename().string());
    return names;
}

std::optional<RandomAccessFile> RandomAccessFile::open(const std::filesystem::path& path,
                                                       std::error_code& failure) {
    const int file = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (file >= 0) return RandomAccessFile(file);
    failure = std::error_code(errno, std::generic_category());
    return std::nullopt;
}

RandomAccessFile::RandomAccessFile(RandomAccessFile&& other) noexcept
    : handle_(std::exchange(other.handle_, -1)) {}

RandomAccessFile::~RandomAccessFile() {
    if (handle_ >= 0) ::close(static_cast<int>(handle_));
}

std::optional<size_t> RandomAccessFile::read(char* bytes, size_t count, uint64_t offset) const {
    while (true) {
        const ssize_t done =
            ::pread(static_cast<int>(handle_), bytes, count, static_cast<off_t>(offset));
        if (done >= 0) return static_cast<size_t>(done);
        if (errno != EINTR) return std::nullopt;
    }
}

std::optional<FileLock> FileLock::take(const std::filesystem::path& path, bool& is_held) {
    constexpr mode_t own = S_IRUSR | S_IWUSR;
    const int file = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, own);
    is_held = false;
    if (file < 0) return std::nullopt;
    if (::flock(file, LOCK_EX | LOCK_NB) == 0) return FileLock(file, path);
    is_held = errno == EWOULDBLOCK;
    ::close(file);
    return std::nullopt;
}

FileLock::FileLock(FileLock&& other) noexcept
    : handle_(std::exchange(other.handle_, -1)), path_(std::move(other.path_)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
    std::swap(handle_, other.handle_);
    std::swap(path_, other.path_);
    return *this;
}

FileLock::~FileLock() {
    if (handle_ < 0) return;
    ::unlink(path_.c_str());
    ::close(static_cast<int>(handle_));
}

} // namespace core::platform
