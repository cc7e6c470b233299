#pragma once

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

/// What standard C++ does not offer. All other code is the same for every system. Text is UTF-8,
/// and so are paths that are stored as strings.
namespace core::platform {

// --- the process ------------------------------------------------------------------------------

/// Prepares standard input and output for UTF-8 and returns the arguments. To be called once,
/// before anything is printed.
std::vector<std::string> begin_program(int argc, char** argv);

/// Whether the program has a console window of its own, because it was started from a file manager
/// and not from a shell: only on Windows.
bool has_own_console();

/// Closes that window.
void close_own_console();

/// The path of this program; empty if it is unknown.
std::filesystem::path program_path();

/// What identifies this build: a digest of the program by its linker; empty if it has none.
std::string build_id();

unsigned process_id();

/// Whether a process with this id runs.
bool is_running(unsigned process);

/// The value of an environment variable; empty if it is unset or empty.
std::string environment_variable(const char* name);

/// Folders of this user: of settings, of what a program remembers, of pictures, of documents, and
/// the one that holds them. Empty if they are unknown; they may not exist yet.
std::filesystem::path settings_folder();
std::filesystem::path state_folder();
std::filesystem::path pictures_folder();
std::filesystem::path documents_folder();
std::filesystem::path home_folder();

/// The roots of drives that the user may have added: mounted below /media, /run/media or /mnt, or
/// the drive letters. Their contents are not touched.
std::vector<std::filesystem::path> drive_folders();

/// Size of the main memory in bytes; 0 if it is unknown.
double physical_memory();

/// Returns freed memory to the system, which an allocator may keep.
void release_free_memory();

/// CPU time of the calling thread; that of a steady clock where the system counts CPU time
/// coarsely.
double thread_cpu_seconds();

/// Milliseconds of a steady clock; may be called while an interrupt is handled.
int64_t steady_milliseconds();

/// The ways in which a user asks a program to stop.
enum class Interrupts : uint8_t {
    keys, // Ctrl-C
    all,  // also the end of the session and requests of other programs
};

/// Calls `note` for each interrupt from now on, instead of ending the program. It may be called in
/// another thread or in a signal handler.
void catch_interrupts(Interrupts which, void (*note)(int which));

/// Ends the program as the interrupt that was noted would have done.
void end_by_interrupt(int which);

/// From now on writing to a closed pipe fails instead of ending the program.
void ignore_broken_pipes();

/// Runs a program without input and output, found as a shell does. Its exit status; empty if it
/// cannot be started or crashes.
std::optional<int> run_quietly(const std::vector<std::string>& words);

/// Memory that another process shares under a key (System V). It stays until the program ends. Null
/// if there is none of at least this size, and on systems without such memory.
void* shared_memory(uint32_t key, size_t bytes);

/// A program that runs beside this one, whose standard input and output are pipes to it. Its
/// standard error is that of this program.
class Companion {
public:
    /// Starts a program, found as a shell does. Empty if it cannot be started, and on Windows.
    static std::optional<Companion> start(const std::vector<std::string>& words);

    Companion(Companion&& other) noexcept;
    Companion& operator=(Companion&& other) noexcept;
    /// Closes its input and ends it.
    ~Companion();

    /// Writes to its input without waiting. False if it does not take all of it.
    bool write(const std::string& text);
    /// What it has written since the last call. Does not wait.
    std::string read();
    /// Whether its output is still open.
    bool is_open() const { return is_open_; }

private:
    Companion() = default;
    void end();

    int process_ = -1, input_ = -1, output_ = -1;
    bool is_open_ = false;
};

// --- terminals --------------------------------------------------------------------------------

bool is_terminal(std::FILE* stream);

/// Columns of the terminal that a stream writes to; empty if it is none.
std::optional<size_t> terminal_width(std::FILE* stream);

// --- files ------------------------------------------------------------------------------------

/// Metadata of a file or folder. Links are followed.
struct FileFacts {
    bool is_folder = false;
    bool is_file = false; // a regular file
    uint64_t device = 0, number = 0, size = 0;
    int64_t modified = 0, changed = 0; // nanoseconds since 1970
};
std::optional<FileFacts> facts_of(const std::filesystem::path& path);

/// Whether both paths lead to one file that exists, also through two drives or shares.
bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Whether a path names a device of the system and not a file: NUL, CON on Windows.
bool is_device(const std::filesystem::path& path);

/// As std::fopen.
std::FILE* open_file(const std::filesystem::path& path, const char* mode);

/// Flushes a file to the disk. Whether all of it was written.
bool write_through(std::FILE* file);

/// Gives a file the group and the permissions of the one that it will replace, as far as the user
/// may. Windows inherits them from the folder.
void take_permissions(const std::filesystem::path& fresh, const std::filesystem::path& old);

/// Renames a file over another. Waits for a moment if another program has that open, where this is
/// in the way.
std::error_code replace_file(const std::filesystem::path& fresh, const std::filesystem::path& old);

/// Creates a folder of its own for this program; empty if that is impossible.
std::filesystem::path make_temporary_folder(const char* name);

/// A path that a user wrote, with '/' between its parts: as paths are stored and reported.
std::string with_slashes(std::string path);

/// A whole path with the upper and lower case of the file system, where names that differ only in
/// case are one file. The path itself if there is no such file.
std::filesystem::path in_stored_case(const std::filesystem::path& path);

/// What separates the folders of a list of folders: ':', or ';' where ':' follows a drive.
char list_separator();

/// A file name in one case where upper and lower case do not differ in file names.
std::string case_folded(const std::string& name);

/// The names of the files and folders in a folder, in any order. The reason is in `failure` if it
/// cannot be listed.
std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& failure);

/// A file that is read at any position. Other programs may replace or delete it meanwhile.
class RandomAccessFile {
public:
    /// Empty if it cannot be opened; the reason is in `failure`.
    static std::optional<RandomAccessFile> open(const std::filesystem::path& path,
                                                std::error_code& failure);
    RandomAccessFile(RandomAccessFile&& other) noexcept;
    RandomAccessFile& operator=(RandomAccessFile&&) = delete;
    ~RandomAccessFile();

    /// Reads up to `count` bytes at `offset`: their number, 0 at the end, empty if reading fails.
    std::optional<size_t> read(char* bytes, size_t count, uint64_t offset) const;

private:
    explicit RandomAccessFile(intptr_t handle) : handle_(handle) {}

    intptr_t handle_;
};

/// A file that one owner holds at a time, until it lets go or its process ends, however it ends.
class FileLock {
public:
    /// Makes the file and holds it. Empty if another owner, of this process or another one, holds
    /// it, which `is_held` then says, or if the file cannot be made.
    static std::optional<FileLock> take(const std::filesystem::path& path, bool& is_held);
    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&& other) noexcept;
    /// Lets go, and deletes the file.
    ~FileLock();

private:
    FileLock(intptr_t handle, std::filesystem::path path)
        : handle_(handle), path_(std::move(path)) {}

    intptr_t handle_;
    std::filesystem::path path_;
};

} // namespace core::platform
