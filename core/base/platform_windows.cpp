#define WIN32_LEAN_AND_MEAN
#include <windows.h>

// After windows.h.
#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <random>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <io.h>
#include <shellapi.h>
#include <shlobj.h>

#include "core/base/platform.h"

/// In place of mbrtowc (--wrap of the linker), with which libstdc++ turns the bytes of a
/// std::filesystem::path into UTF-16. The C runtime of MinGW-w64 has no locale with UTF-8, which
/// all text of this program is. A character above U+FFFF has two units: its first three bytes give
/// the first, its last byte the second, which waits in the state. Bytes that are no UTF-8, as from
/// an old NC program, count as Latin-1.
extern "C" size_t __wrap_mbrtowc(wchar_t* unit, const char* bytes, size_t count, mbstate_t* state) {
    static mbstate_t of_all{};
    mbstate_t& waiting = state ? *state : of_all;
    const auto give = [&](unsigned code, size_t taken) {
        if (unit) *unit = static_cast<wchar_t>(code);
        return taken;
    };
    if (!bytes || count == 0) return 0;
    if (waiting != 0) return give(static_cast<unsigned>(std::exchange(waiting, 0)), 1);
    const auto at = [&](size_t i) { return unsigned{static_cast<unsigned char>(bytes[i])}; };
    const unsigned first = at(0);
    if (first == 0) return give(0, 0);
    const size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : first >= 0xC0 ? 2 : 1;
    if (length == 1 || length > count) return give(first, 1);
    unsigned code = first & (0x7FU >> length);
    for (size_t i = 1; i < length; ++i) {
        if ((at(i) & 0xC0U) != 0x80U) return give(first, 1);
        code = code << 6U | (at(i) & 0x3FU);
    }
    constexpr unsigned least[] = {0, 0, 0x80, 0x800, 0x10000};
    const bool is_surrogate = code >= 0xD800 && code < 0xE000;
    if (code < least[length] || code > 0x10FFFF || is_surrogate) return give(first, 1);
    if (code < 0x10000) return give(code, length);
    waiting = static_cast<mbstate_t>(0xDC00U + ((code - 0x10000) & 0x3FFU));
    return give(0xD800U + ((code - 0x10000) >> 10U), 3);
}

namespace core::platform {
namespace {

std::string utf8(std::wstring_view text) {
    const int length = static_cast<int>(text.size());
    const int size =
        ::WideCharToMultiByte(CP_UTF8, 0, text.data(), length, nullptr, 0, nullptr, nullptr);
    std::string bytes(static_cast<size_t>(size), '\0');
    ::WideCharToMultiByte(CP_UTF8, 0, text.data(), length, bytes.data(), size, nullptr, nullptr);
    return bytes;
}

std::wstring wide(std::string_view text) {
    const int length = static_cast<int>(text.size());
    const int size = ::MultiByteToWideChar(CP_UTF8, 0, text.data(), length, nullptr, 0);
    std::wstring units(static_cast<size_t>(size), L'\0');
    ::MultiByteToWideChar(CP_UTF8, 0, text.data(), length, units.data(), size);
    return units;
}

std::error_code last_error() {
    return {static_cast<int>(::GetLastError()), std::system_category()};
}

/// A handle that is closed at the end of its scope.
class Handle {
public:
    explicit Handle(HANDLE handle) : handle_(handle) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (is_open()) ::CloseHandle(handle_);
    }
    bool is_open() const { return handle_ != INVALID_HANDLE_VALUE && handle_ != nullptr; }
    HANDLE get() const { return handle_; }

private:
    HANDLE handle_;
};

HANDLE handle_of(std::FILE* stream) {
    return reinterpret_cast<HANDLE>(::_get_osfhandle(::_fileno(stream)));
}

// Of the console, for the end of the program: it belongs to the shell, too.
UINT code_page_before = 0;

extern "C" void restore_console() { ::SetConsoleOutputCP(code_page_before); }

/// Where no other handler takes an event, it ends the program at once, without std::atexit.
BOOL WINAPI restore_at_control(DWORD) {
    restore_console();
    return FALSE;
}

/// Lets a console show UTF-8 and colours.
void prepare(std::FILE* stream) {
    ::_setmode(::_fileno(stream), _O_BINARY);
    DWORD mode = 0;
    if (!::GetConsoleMode(handle_of(stream), &mode)) return;
    ::SetConsoleMode(handle_of(stream), mode | ENABLE_VIRTUAL_TERMINAL_PROCESSING);
    // Unbuffered, as the runtime has it, a character of several bytes would be written in parts.
    std::setvbuf(stream, nullptr, _IOFBF, 1U << 16U);
}

/// An argument; a path on a drive or a network share with slashes, as all paths are shown, and
/// without the prefix of long paths, which are known without it.
std::string argument(std::string word) {
    if (word.starts_with(R"(\\?\UNC\)")) word.replace(0, 8, R"(\\)");
    if (word.starts_with(R"(\\?\)") && word.size() > 5 && word[5] == ':') word.erase(0, 4);
    const bool is_share =
        word.size() > 2 && word.starts_with(R"(\\)") && word[2] != '?' && word[2] != '.';
    const bool is_on_drive = word.size() > 2 && word[1] == ':' && word[2] == '\\';
    return is_share || is_on_drive ? with_slashes(std::move(word)) : word;
}

} // namespace

std::vector<std::string> begin_program(int, char**) {
    prepare(stdout);
    prepare(stderr);
    ::_setmode(::_fileno(stdin), _O_BINARY);
    code_page_before = ::GetConsoleOutputCP();
    if (code_page_before != 0 && ::SetConsoleOutputCP(CP_UTF8)) {
        std::atexit(restore_console);
        ::SetConsoleCtrlHandler(restore_at_control, TRUE);
    }
    int count = 0;
    wchar_t** const words = ::CommandLineToArgvW(::GetCommandLineW(), &count);
    std::vector<std::string> arguments;
    for (int i = 0; i < count; ++i) arguments.push_back(argument(utf8(words[i])));
    ::LocalFree(words);
    return arguments;
}

bool has_own_console() {
    DWORD first = 0;
    return ::GetConsoleProcessList(&first, 1) == 1;
}

void close_own_console() {
    if (has_own_console()) ::FreeConsole();
}

std::filesystem::path program_path() {
    constexpr size_t longest = 32768;
    std::wstring path(longest, L'\0');
    const DWORD length = ::GetModuleFileNameW(nullptr, path.data(), longest);
    path.resize(length < longest ? length : 0);
    return path;
}

namespace {

/// What the linker writes with --build-id: the entry of a debug directory that names a file of
/// debug information and its GUID. Source: Microsoft, PE Format, .debug section.
struct CodeView {
    char signature[4]; // "RSDS"
    unsigned char guid[16];
};

template <typename T>
T at_offset(const char* image, size_t offset) {
    T value;
    std::memcpy(&value, image + offset, sizeof value);
    return value;
}

} // namespace

std::string build_id() {
    const auto* image = reinterpret_cast<const char*>(::GetModuleHandleW(nullptr));
    const auto dos = at_offset<IMAGE_DOS_HEADER>(image, 0);
    const auto headers = at_offset<IMAGE_NT_HEADERS>(image, static_cast<size_t>(dos.e_lfanew));
    const IMAGE_DATA_DIRECTORY& debug =
        headers.OptionalHeader.DataDirectory[IMAGE_DIRECTORY_ENTRY_DEBUG];
    for (DWORD at = 0; at + sizeof(IMAGE_DEBUG_DIRECTORY) <= debug.Size;
         at += sizeof(IMAGE_DEBUG_DIRECTORY)) {
        const auto entry = at_offset<IMAGE_DEBUG_DIRECTORY>(image, debug.VirtualAddress + at);
        if (entry.Type != IMAGE_DEBUG_TYPE_CODEVIEW || entry.SizeOfData < sizeof(CodeView))
            continue;
        const auto view = at_offset<CodeView>(image, entry.AddressOfRawData);
        if (std::memcmp(view.signature, "RSDS", 4) != 0) continue;
        std::string id;
        for (const unsigned char byte : view.guid) id += fmt::format("{:02x}", byte);
        return id;
    }
    return {};
}

bool is_running(unsigned process) {
    const HANDLE handle = ::OpenProcess(SYNCHRONIZE, FALSE, process);
    if (!handle) return false;
    const bool runs = ::WaitForSingleObject(handle, 0) == WAIT_TIMEOUT;
    ::CloseHandle(handle);
    return runs;
}

unsigned process_id() { return ::GetCurrentProcessId(); }

std::string environment_variable(const char* name) {
    const wchar_t* const value = ::_wgetenv(wide(name).c_str());
    return value ? utf8(value) : std::string();
}

namespace {

std::filesystem::path known_folder(const KNOWNFOLDERID& which) {
    wchar_t* path = nullptr;
    std::filesystem::path folder;
    if (::SHGetKnownFolderPath(which, KF_FLAG_DONT_VERIFY, nullptr, &path) == S_OK) folder = path;
    ::CoTaskMemFree(path);
    return folder;
}

} // namespace

std::filesystem::path settings_folder() { return known_folder(FOLDERID_RoamingAppData); }
std::filesystem::path state_folder() { return known_folder(FOLDERID_LocalAppData); }
std::filesystem::path pictures_folder() { return known_folder(FOLDERID_Pictures); }
std::filesystem::path documents_folder() { return known_folder(FOLDERID_Documents); }
std::filesystem::path home_folder() { return known_folder(FOLDERID_Profile); }

std::vector<std::filesystem::path> drive_folders() {
    std::vector<std::filesystem::path> found;
    const DWORD drives = ::GetLogicalDrives();
    for (int i = 0; i < 26; ++i)
        if (drives & (DWORD{1} << i))
            found.emplace_back(std::string(1, static_cast<char>('A' + i)) + ":/");
    return found;
}

double physical_memory() {
    MEMORYSTATUSEX status{};
    status.dwLength = sizeof status;
    return ::GlobalMemoryStatusEx(&status) ? static_cast<double>(status.ullTotalPhys) : 0.0;
}

void release_free_memory() { ::_heapmin(); }

double thread_cpu_seconds() {
    // The times of a thread are counted in ticks of 15.6 ms.
    LARGE_INTEGER ticks{}, per_second{};
    ::QueryPerformanceCounter(&ticks);
    ::QueryPerformanceFrequency(&per_second);
    return static_cast<double>(ticks.QuadPart) / static_cast<double>(per_second.QuadPart);
}

int64_t steady_milliseconds() { return static_cast<int64_t>(::GetTickCount64()); }

namespace {

std::atomic<void (*)(int)> interrupt_note = nullptr;

BOOL WINAPI handle_control(DWORD event) {
    void (*const note)(int) = interrupt_note;
    if (!note) return FALSE;
    note(static_cast<int>(event));
    // The program ends when the handler of these returns, so it gets the time that it may take.
    if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) ::Sleep(INFINITE);
    return TRUE;
}

BOOL WINAPI handle_keys(DWORD event) {
    return event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT ? handle_control(event) : FALSE;
}

} // namespace

void catch_interrupts(Interrupts which, void (*note)(int)) {
    interrupt_note = note;
    ::SetConsoleCtrlHandler(which == Interrupts::all ? handle_control : handle_keys, TRUE);
}

void end_by_interrupt(int) {
    if (code_page_before != 0) restore_console();
    ::ExitProcess(static_cast<UINT>(STATUS_CONTROL_C_EXIT));
}

void ignore_broken_pipes() {}

namespace {

/// A word as the C runtime of the program takes it apart. Source: Microsoft, Parsing C command-line
/// arguments.
std::wstring quoted(const std::wstring& word) {
    if (!word.empty() && word.find_first_of(L" \t\"") == std::wstring::npos) return word;
    std::wstring text = L"\"";
    size_t backslashes = 0;
    for (const wchar_t c : word) {
        if (c == L'"') text.append(backslashes + 1, L'\\');
        backslashes = c == L'\\' ? backslashes + 1 : 0;
        text += c;
    }
    return text.append(backslashes, L'\\') + L'"';
}

/// The path of a program in the folders of PATH alone: not in the current folder, which may belong
/// to anybody. Empty if there is none.
std::wstring on_path(const std::wstring& name) {
    if (name.find_first_of(L"\\/:") != std::wstring::npos) return name;
    const wchar_t* const folders = ::_wgetenv(L"PATH");
    constexpr size_t longest = 32768;
    std::wstring path(longest, L'\0');
    const DWORD length =
        folders ? ::SearchPathW(folders, name.c_str(), L".exe", longest, path.data(), nullptr) : 0;
    path.resize(length < longest ? length : 0);
    return path;
}

} // namespace

void* shared_memory(uint32_t, size_t) { return nullptr; }

std::optional<Companion> Companion::start(const std::vector<std::string>&) { return {}; }
Companion::Companion(Companion&&) noexcept {}
Companion& Companion::operator=(Companion&&) noexcept { return *this; }
Companion::~Companion() = default;
bool Companion::write(const std::string&) { return false; }
std::string Companion::read() { return {}; }

std::optional<int> run_quietly(const std::vector<std::string>& words) {
    std::wstring line;
    for (const std::string& word : words) line += (line.empty() ? L"" : L" ") + quoted(wide(word));
    SECURITY_ATTRIBUTES inherited{sizeof inherited, nullptr, TRUE};
    const Handle nothing(::CreateFileW(L"NUL", GENERIC_READ | GENERIC_WRITE,
                                       FILE_SHARE_READ | FILE_SHARE_WRITE, &inherited,
                                       OPEN_EXISTING, 0, nullptr));
    STARTUPINFOW start{};
    start.cb = sizeof start;
    start.dwFlags = STARTF_USESTDHANDLES;
    start.hStdInput = start.hStdOutput = nothing.get();
    start.hStdError = handle_of(stderr);
    PROCESS_INFORMATION process{};
    const std::wstring program = words.empty() ? std::wstring() : on_path(wide(words[0]));
    if (program.empty()
        || !::CreateProcessW(program.c_str(), line.data(), nullptr, nullptr, TRUE, CREATE_NO_WINDOW,
                             nullptr, nullptr, &start, &process))
        return std::nullopt;
    const Handle child(process.hProcess), thread(process.hThread);
    DWORD status = 0;
    if (::WaitForSingleObject(child.get(), INFINITE) != WAIT_OBJECT_0
        || !::GetExitCodeProcess(child.get(), &status) || status > 255)
        return std::nullopt;
    return static_cast<int>(status);
}

bool is_terminal(std::FILE* stream) {
    DWORD mode = 0;
    return ::GetConsoleMode(handle_of(stream), &mode) != 0;
}

std::optional<size_t> terminal_width(std::FILE* stream) {
    CONSOLE_SCREEN_BUFFER_INFO info{};
    if (!::GetConsoleScreenBufferInfo(handle_of(stream), &info)) return std::nullopt;
    return static_cast<size_t>(info.srWindow.Right - info.srWindow.Left + 1);
}

namespace {

constexpr DWORD share_all = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

/// Nanoseconds since 1970, from steps of 100 ns since 1601; 0 where the file system stores no such
/// time, as FAT for changes.
int64_t nanoseconds(const LARGE_INTEGER& time) {
    constexpr int64_t from = 116'444'736'000'000'000, century = 31'556'952'000'000'000;
    return (std::clamp<int64_t>(time.QuadPart, from, from + 2 * century) - from) * 100;
}

/// Letters as file systems of Windows compare them.
std::wstring folded(std::wstring text) {
    ::CharLowerBuffW(text.data(), static_cast<DWORD>(text.size()));
    return text;
}

uint64_t joined(DWORD high, DWORD low) { return uint64_t{high} << 32U | low; }

/// The path by which the system knows an open file; empty if it does not say.
std::wstring final_path(const Handle& file) {
    constexpr DWORD longest = 32768;
    std::wstring path(longest, L'\0');
    const DWORD length = ::GetFinalPathNameByHandleW(file.get(), path.data(), longest, 0);
    path.resize(length < longest ? length : 0);
    return path;
}

/// The number of a file on its volume. Where the file system has none, the server says 0 or -1
/// (MS-FSCC 2.4.22), and the path serves instead.
uint64_t number_of(const Handle& file, const BY_HANDLE_FILE_INFORMATION& info) {
    const uint64_t number = joined(info.nFileIndexHigh, info.nFileIndexLow);
    return number != 0 && number != ~uint64_t{0} ? number
                                                 : std::hash<std::wstring>()(final_path(file));
}

} // namespace

std::optional<FileFacts> facts_of(const std::filesystem::path& path) {
    const Handle file(::CreateFileW(path.c_str(), FILE_READ_ATTRIBUTES, share_all, nullptr,
                                    OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr));
    BY_HANDLE_FILE_INFORMATION info{};
    FILE_BASIC_INFO times{};
    if (!file.is_open() || !::GetFileInformationByHandle(file.get(), &info)
        || !::GetFileInformationByHandleEx(file.get(), FileBasicInfo, &times, sizeof times))
        return std::nullopt;
    const bool is_folder = (info.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
    return FileFacts{.is_folder = is_folder,
                     .is_file = !is_folder && ::GetFileType(file.get()) == FILE_TYPE_DISK,
                     .device = info.dwVolumeSerialNumber,
                     .number = number_of(file, info),
                     .size = joined(info.nFileSizeHigh, info.nFileSizeLow),
                     .modified = nanoseconds(times.LastWriteTime),
                     .changed = nanoseconds(times.ChangeTime)};
}

std::filesystem::path in_stored_case(const std::filesystem::path& path) {
    const Handle file(::CreateFileW(path.c_str(), FILE_READ_ATTRIBUTES, share_all, nullptr,
                                    OPEN_EXISTING, FILE_FLAG_BACKUP_SEMANTICS, nullptr));
    if (!file.is_open()) return path;
    // The system may know the file by another drive or share: then its last parts count.
    const std::wstring own = path.generic_wstring();
    const std::wstring stored = std::filesystem::path(final_path(file)).generic_wstring();
    const std::wstring own_folded = folded(own), stored_folded = folded(stored);
    size_t same = 0, whole_parts = 0;
    while (same < std::min(own.size(), stored.size())
           && own_folded[own.size() - 1 - same] == stored_folded[stored.size() - 1 - same]) {
        ++same;
        if (same == own.size() || own[own.size() - same] == L'/') whole_parts = same;
    }
    return own.substr(0, own.size() - whole_parts) + stored.substr(stored.size() - whole_parts);
}

bool is_same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    const auto one = facts_of(a), other = facts_of(b);
    return one && other && one->device == other->device && one->number == other->number;
}

bool is_device(const std::filesystem::path& path) {
    constexpr size_t longest = 32768;
    std::wstring whole(longest, L'\0');
    const DWORD length = ::GetFullPathNameW(path.c_str(), longest, whole.data(), nullptr);
    whole.resize(length < longest ? length : 0);
    return whole.starts_with(LR"(\\.\)");
}

std::FILE* open_file(const std::filesystem::path& path, const char* mode) {
    if (std::string_view(mode) != "rb") return ::_wfopen(path.c_str(), wide(mode).c_str());
    // _wfopen does not let other programs replace or delete the file meanwhile.
    const HANDLE file = ::CreateFileW(path.c_str(), GENERIC_READ, share_all, nullptr, OPEN_EXISTING,
                                      FILE_ATTRIBUTE_NORMAL, nullptr);
    if (file == INVALID_HANDLE_VALUE) {
        errno = last_error().default_error_condition().value();
        return nullptr;
    }
    const int number = ::_open_osfhandle(reinterpret_cast<intptr_t>(file), _O_RDONLY | _O_BINARY);
    if (number >= 0) return ::_fdopen(number, mode);
    ::CloseHandle(file);
    return nullptr;
}

bool write_through(std::FILE* file) { return ::_commit(::_fileno(file)) == 0; }

void take_permissions(const std::filesystem::path&, const std::filesystem::path&) {}

std::error_code replace_file(const std::filesystem::path& fresh, const std::filesystem::path& old) {
    constexpr int attempts = 20;
    constexpr DWORD pause = 50; // ms; virus scanners open new files for a moment
    for (int i = 0;; ++i) {
        if (::MoveFileExW(fresh.c_str(), old.c_str(),
                          MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
            return {};
        const std::error_code failure = last_error();
        const bool is_in_use = failure.value() == ERROR_SHARING_VIOLATION
                               || failure.value() == ERROR_ACCESS_DENIED
                               || failure.value() == ERROR_LOCK_VIOLATION;
        if (!is_in_use || i == attempts) return failure;
        ::Sleep(pause);
    }
}

std::string with_slashes(std::string path) {
    std::replace(path.begin(), path.end(), '\\', '/');
    if (path.size() == 2 && path[1] == ':') path += '.'; // the current folder of a drive
    return path;
}

char list_separator() { return ';'; }

std::filesystem::path make_temporary_folder(const char* name) {
    std::random_device random;
    for (int i = 0; i < 100; ++i) {
        std::error_code failure;
        const std::filesystem::path folder = std::filesystem::temp_directory_path(failure)
                                             / fmt::format("{}-{:08x}", name, random());
        if (!failure && std::filesystem::create_directory(folder, failure)) return folder;
        if (failure) break;
    }
    return {};
}

std::string case_folded(const std::string& name) { return utf8(folded(wide(name))); }

std::vector<std::string> names_in(const std::filesystem::path& folder, std::error_code& failure) {
    // That of the C++ library takes no more than 260 characters.
    failure.clear();
    std::vector<std::string> names;
    WIN32_FIND_DATAW found{};
    const HANDLE search = ::FindFirstFileW((folder / L"*").c_str(), &found);
    if (search == INVALID_HANDLE_VALUE) {
        if (::GetLastError() != ERROR_FILE_NOT_FOUND) failure = last_error();
        return names;
    }
    do {
        const std::wstring_view name = found.cFileName;
        if (name != L"." && name != L"..") names.push_back(utf8(name));
    } while (::FindNextFileW(search, &found));
    if (::GetLastError() != ERROR_NO_MORE_FILES) failure = last_error();
    ::FindClose(search);
    return names;
}

std::optional<RandomAccessFile> RandomAccessFile::open(const std::filesystem::path& path,
                                                       std::error_code& failure) {
    const HANDLE file = ::CreateFileW(path.c_str(), GENERIC_READ, share_all, nullptr, OPEN_EXISTING,
                                      FILE_ATTRIBUTE_NORMAL, nullptr);
    if (file != INVALID_HANDLE_VALUE) return RandomAccessFile(reinterpret_cast<intptr_t>(file));
    failure = last_error();
    return std::nullopt;
}

RandomAccessFile::RandomAccessFile(RandomAccessFile&& other) noexcept
    : handle_(std::exchange(other.handle_, -1)) {}

RandomAccessFile::~RandomAccessFile() {
    if (handle_ != -1) ::CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

std::optional<size_t> RandomAccessFile::read(char* bytes, size_t count, uint64_t offset) const {
    OVERLAPPED position{};
    position.Offset = static_cast<DWORD>(offset);
    position.OffsetHigh = static_cast<DWORD>(offset >> 32U);
    DWORD done = 0;
    const auto wanted = static_cast<DWORD>(count < (1U << 30U) ? count : 1U << 30U);
    if (::ReadFile(reinterpret_cast<HANDLE>(handle_), bytes, wanted, &done, &position)) return done;
    if (::GetLastError() == ERROR_HANDLE_EOF) return 0;
    return std::nullopt;
}

std::optional<FileLock> FileLock::take(const std::filesystem::path& path, bool& is_held) {
    constexpr DWORD share_nothing = 0;
    const HANDLE file =
        ::CreateFileW(path.c_str(), GENERIC_READ | GENERIC_WRITE, share_nothing, nullptr,
                      OPEN_ALWAYS, FILE_ATTRIBUTE_NORMAL | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
    is_held = file == INVALID_HANDLE_VALUE && ::GetLastError() == ERROR_SHARING_VIOLATION;
    if (file == INVALID_HANDLE_VALUE) return std::nullopt;
    return FileLock(reinterpret_cast<intptr_t>(file), path);
}

FileLock::FileLock(FileLock&& other) noexcept
    : handle_(std::exchange(other.handle_, -1)), path_(std::move(other.path_)) {}

FileLock& FileLock::operator=(FileLock&& other) noexcept {
    std::swap(handle_, other.handle_);
    std::swap(path_, other.path_);
    return *this;
}

FileLock::~FileLock() {
    if (handle_ != -1) ::CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

} // namespace core::platform
