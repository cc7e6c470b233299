#include <string>

#define GLFW_INCLUDE_NONE
#define GLFW_EXPOSE_NATIVE_WIN32
#include <GLFW/glfw3.h>
#include <GLFW/glfw3native.h>
#include <shobjidl.h>
#include <windows.h>

#include "app/view/ui/system_dialog.h"
#include "core/base/platform.h"

namespace app::viewer {
namespace {

/// COM in this thread.
struct ComThread {
    HRESULT state = ::CoInitializeEx(nullptr, COINIT_APARTMENTTHREADED | COINIT_DISABLE_OLE1DDE);
    ~ComThread() {
        if (SUCCEEDED(state)) ::CoUninitialize();
    }
};

/// A COM object that is released at its end.
template <typename Object>
struct ComPointer {
    Object* object = nullptr;

    ComPointer() = default;
    ComPointer(const ComPointer&) = delete;
    ComPointer& operator=(const ComPointer&) = delete;
    ~ComPointer() {
        if (object) object->Release();
    }
    void** target() { return reinterpret_cast<void**>(&object); }
};

std::wstring wide_text(const std::string& text) {
    const int size = static_cast<int>(text.size());
    std::wstring wide(
        static_cast<size_t>(::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0)),
        L'\0');
    ::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, wide.data(),
                          static_cast<int>(wide.size()));
    return wide;
}

std::string utf8_of(const wchar_t* wide) {
    const int size = ::WideCharToMultiByte(CP_UTF8, 0, wide, -1, nullptr, 0, nullptr, nullptr);
    if (size <= 1) return {};
    std::string text(static_cast<size_t>(size), '\0');
    ::WideCharToMultiByte(CP_UTF8, 0, wide, -1, text.data(), size, nullptr, nullptr);
    text.pop_back(); // the zero at the end
    return text;
}

void set_filters(IFileDialog& dialog, FileWish wish) {
    const FileEndings kind = endings_for(wish);
    if (kind.endings.empty()) return;
    std::string patterns;
    for (const std::string& each : kind.endings)
        patterns += (patterns.empty() ? "*." : ";*.") + each;
    const std::wstring name = wide_text(kind.name), wide = wide_text(patterns);
    const COMDLG_FILTERSPEC filters[] = {{name.c_str(), wide.c_str()}, {L"All files", L"*.*"}};
    dialog.SetFileTypes(2, filters);
    if (saves(wish)) dialog.SetDefaultExtension(wide_text(kind.endings.front()).c_str());
}

void set_folder(IFileDialog& dialog, const std::string& folder) {
    ComPointer<IShellItem> item;
    std::wstring path = wide_text(folder);
    for (wchar_t& c : path)
        if (c == L'/') c = L'\\';
    if (SUCCEEDED(
            ::SHCreateItemFromParsingName(path.c_str(), nullptr, IID_IShellItem, item.target())))
        dialog.SetFolder(item.object);
}

std::optional<std::string> chosen_in(IFileDialog& dialog) {
    ComPointer<IShellItem> item;
    wchar_t* path = nullptr;
    if (FAILED(dialog.GetResult(&item.object))
        || FAILED(item.object->GetDisplayName(SIGDN_FILESYSPATH, &path)))
        return {};
    const std::string text = utf8_of(path);
    ::CoTaskMemFree(path);
    return core::platform::with_slashes(text);
}

} // namespace

uintptr_t native_window(GLFWwindow* window) {
    return reinterpret_cast<uintptr_t>(::glfwGetWin32Window(window));
}

DialogUpdate ask_system(const DialogJob& job, const std::function<bool()>& is_over) {
    const ComThread com;
    const bool is_saving = saves(job.wish);
    ComPointer<IFileDialog> dialog;
    if (FAILED(com.state)
        || FAILED(::CoCreateInstance(is_saving ? CLSID_FileSaveDialog : CLSID_FileOpenDialog,
                                     nullptr, CLSCTX_INPROC_SERVER, IID_IFileDialog,
                                     dialog.target())))
        return {.is_absent = true};
    FILEOPENDIALOGOPTIONS options = 0;
    dialog.object->GetOptions(&options);
    options |= FOS_FORCEFILESYSTEM | FOS_NOCHANGEDIR;
    dialog.object->SetOptions(options);
    dialog.object->SetTitle(wide_text(job.title).c_str());
    set_filters(*dialog.object, job.wish);
    if (!job.folder.empty()) set_folder(*dialog.object, job.folder);
    if (is_saving) dialog.object->SetFileName(wide_text(job.name).c_str());
    if (is_over()) return {};
    const HRESULT shown = dialog.object->Show(reinterpret_cast<HWND>(job.window));
    if (shown == HRESULT_FROM_WIN32(ERROR_CANCELLED)) return {};
    if (FAILED(shown)) return {.is_absent = true};
    return {.path = chosen_in(*dialog.object)};
}

} // namespace app::viewer
