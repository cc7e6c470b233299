#include <cstring>
#include <string_view>

#include <dlfcn.h>
#include <fmt/format.h>

#include "app/view/ui/system_dialog.h"
#include "core/base/platform.h"

namespace app::viewer {
namespace {

// The part of libdbus that is used, as its headers declare it.
struct DBusConnection;
struct DBusMessage;
struct alignas(void*) DBusIter {
    char bytes[128]; // more than a DBusMessageIter needs
};

constexpr int session_bus = 0;
constexpr int type_array = 'a', type_string = 's', type_variant = 'v', type_boolean = 'b',
              type_entry = 'e', type_struct = 'r', type_byte = 'y', type_uint32 = 'u';

/// libdbus, loaded when it is first needed.
struct DBusLibrary {
    DBusLibrary();

    bool is_there = false;
    DBusConnection* (*bus_get_private)(int, void*) = nullptr;
    void (*set_exit_on_disconnect)(DBusConnection*, uint32_t) = nullptr;
    void (*bus_add_match)(DBusConnection*, const char*, void*) = nullptr;
    void (*connection_close)(DBusConnection*) = nullptr;
    void (*connection_unref)(DBusConnection*) = nullptr;
    uint32_t (*read_write)(DBusConnection*, int) = nullptr;
    DBusMessage* (*pop_message)(DBusConnection*) = nullptr;
    DBusMessage* (*send_and_block)(DBusConnection*, DBusMessage*, int, void*) = nullptr;
    DBusMessage* (*new_call)(const char*, const char*, const char*, const char*) = nullptr;
    void (*message_unref)(DBusMessage*) = nullptr;
    uint32_t (*is_signal)(DBusMessage*, const char*, const char*) = nullptr;
    uint32_t (*has_path)(DBusMessage*, const char*) = nullptr;
    void (*begin_append)(DBusMessage*, DBusIter*) = nullptr;
    uint32_t (*append)(DBusIter*, int, const void*) = nullptr;
    uint32_t (*open)(DBusIter*, int, const char*, DBusIter*) = nullptr;
    uint32_t (*close)(DBusIter*, DBusIter*) = nullptr;
    uint32_t (*begin_read)(DBusMessage*, DBusIter*) = nullptr;
    int (*type_at)(DBusIter*) = nullptr;
    void (*recurse)(DBusIter*, DBusIter*) = nullptr;
    void (*get)(DBusIter*, void*) = nullptr;
    uint32_t (*next)(DBusIter*) = nullptr;

private:
    template <typename Function>
    void find(void* library, const char* name, Function& function) {
        function = reinterpret_cast<Function>(::dlsym(library, name));
        is_there = is_there && function;
    }
};

DBusLibrary::DBusLibrary() {
    void* const library = ::dlopen("libdbus-1.so.3", RTLD_NOW | RTLD_LOCAL);
    if (!library) return;
    is_there = true;
    find(library, "dbus_bus_get_private", bus_get_private);
    find(library, "dbus_connection_set_exit_on_disconnect", set_exit_on_disconnect);
    find(library, "dbus_bus_add_match", bus_add_match);
    find(library, "dbus_connection_close", connection_close);
    find(library, "dbus_connection_unref", connection_unref);
    find(library, "dbus_connection_read_write", read_write);
    find(library, "dbus_connection_pop_message", pop_message);
    find(library, "dbus_connection_send_with_reply_and_block", send_and_block);
    find(library, "dbus_message_new_method_call", new_call);
    find(library, "dbus_message_unref", message_unref);
    find(library, "dbus_message_is_signal", is_signal);
    find(library, "dbus_message_has_path", has_path);
    find(library, "dbus_message_iter_init_append", begin_append);
    find(library, "dbus_message_iter_append_basic", append);
    find(library, "dbus_message_iter_open_container", open);
    find(library, "dbus_message_iter_close_container", close);
    find(library, "dbus_message_iter_init", begin_read);
    find(library, "dbus_message_iter_get_arg_type", type_at);
    find(library, "dbus_message_iter_recurse", recurse);
    find(library, "dbus_message_iter_get_basic", get);
    find(library, "dbus_message_iter_next", next);
}

const DBusLibrary& dbus() {
    static const DBusLibrary library;
    return library;
}

/// A message that is released at its end.
struct DialogMessage {
    explicit DialogMessage(DBusMessage* m) : message(m) {}
    ~DialogMessage() {
        if (message) dbus().message_unref(message);
    }
    DialogMessage(const DialogMessage&) = delete;
    DialogMessage& operator=(const DialogMessage&) = delete;

    DBusMessage* message;
};

/// A connection to the bus of the session, for one question.
struct SessionBus {
    SessionBus() : connection(dbus().bus_get_private(session_bus, nullptr)) {
        if (connection) dbus().set_exit_on_disconnect(connection, 0);
    }
    ~SessionBus() {
        if (!connection) return;
        dbus().connection_close(connection);
        dbus().connection_unref(connection);
    }
    SessionBus(const SessionBus&) = delete;
    SessionBus& operator=(const SessionBus&) = delete;

    DBusConnection* connection;
};

void append_text(DBusIter& to, const std::string& text) {
    const char* const bytes = text.c_str();
    dbus().append(&to, type_string, static_cast<const void*>(&bytes));
}

/// Writes an entry of a dictionary of variants; `write` writes the value.
template <typename Write>
void append_option(DBusIter& options, const char* name, const char* signature, const Write& write) {
    DBusIter entry{}, value{};
    dbus().open(&options, type_entry, nullptr, &entry);
    append_text(entry, name);
    dbus().open(&entry, type_variant, signature, &value);
    write(value);
    dbus().close(&entry, &value);
    dbus().close(&options, &entry);
}

/// Writes a path as bytes with a zero at the end.
void append_bytes(DBusIter& to, const std::string& path) {
    DBusIter bytes{};
    dbus().open(&to, type_array, "y", &bytes);
    for (size_t i = 0; i <= path.size(); ++i) dbus().append(&bytes, type_byte, path.c_str() + i);
    dbus().close(&to, &bytes);
}

/// Writes a list of one filter: a name and its patterns.
void append_filters(DBusIter& to, FileWish wish) {
    const FileEndings kind = endings_for(wish);
    DBusIter filters{}, filter{}, patterns{}, pattern{};
    dbus().open(&to, type_array, "(sa(us))", &filters);
    dbus().open(&filters, type_struct, nullptr, &filter);
    append_text(filter, kind.name);
    dbus().open(&filter, type_array, "(us)", &patterns);
    const uint32_t glob = 0;
    for (const std::string_view each : kind.endings) {
        dbus().open(&patterns, type_struct, nullptr, &pattern);
        dbus().append(&pattern, type_uint32, &glob);
        std::string either = "*.";
        for (const char c : each) either += fmt::format("[{}{}]", c, static_cast<char>(c - 32));
        append_text(pattern, either);
        dbus().close(&patterns, &pattern);
    }
    dbus().close(&filter, &patterns);
    dbus().close(&filters, &filter);
    dbus().close(&to, &filters);
}

/// The call that opens the dialog.
DBusMessage* call_for(const DialogJob& job) {
    const bool is_saving = saves(job.wish);
    DBusMessage* const call =
        dbus().new_call("org.freedesktop.portal.Desktop", "/org/freedesktop/portal/desktop",
                        "org.freedesktop.portal.FileChooser", is_saving ? "SaveFile" : "OpenFile");
    if (!call) return nullptr;
    DBusIter arguments{}, options{};
    dbus().begin_append(call, &arguments);
    append_text(arguments, job.window != 0 ? fmt::format("x11:{:x}", job.window) : "");
    append_text(arguments, job.title);
    dbus().open(&arguments, type_array, "{sv}", &options);
    append_option(options, "modal", "b", [](DBusIter& to) {
        const uint32_t yes = 1;
        dbus().append(&to, type_boolean, &yes);
    });
    if (!job.folder.empty())
        append_option(options, "current_folder", "ay",
                      [&](DBusIter& to) { append_bytes(to, job.folder); });
    if (is_saving)
        append_option(options, "current_name", "s",
                      [&](DBusIter& to) { append_text(to, job.name); });
    if (!endings_for(job.wish).endings.empty())
        append_option(options, "filters", "a(sa(us))",
                      [&](DBusIter& to) { append_filters(to, job.wish); });
    dbus().close(&arguments, &options);
    return call;
}

/// The first path among the `uris` of an answer.
std::optional<std::string> path_in(DBusMessage* answer) {
    DBusIter at{}, entries{};
    if (!dbus().begin_read(answer, &at) || dbus().type_at(&at) != type_uint32) return {};
    uint32_t code = 1; // 0: chosen
    dbus().get(&at, &code);
    if (code != 0 || !dbus().next(&at) || dbus().type_at(&at) != type_array) return {};
    dbus().recurse(&at, &entries);
    for (; dbus().type_at(&entries) == type_entry; dbus().next(&entries)) {
        DBusIter entry{}, value{}, uris{};
        const char* name = nullptr;
        dbus().recurse(&entries, &entry);
        dbus().get(&entry, static_cast<void*>(&name));
        if (std::string_view(name) != "uris" || !dbus().next(&entry)) continue;
        dbus().recurse(&entry, &value);
        if (dbus().type_at(&value) != type_array) continue;
        dbus().recurse(&value, &uris);
        if (dbus().type_at(&uris) != type_string) continue;
        const char* uri = nullptr;
        dbus().get(&uris, static_cast<void*>(&uri));
        return path_of_uri(uri);
    }
    return {};
}

/// Waits for the answer to a request; empty if the bus or the portal ends.
std::optional<std::string> await_answer(const SessionBus& bus, const std::string& request,
                                        const std::function<bool()>& is_over) {
    constexpr int poll = 100; // milliseconds
    while (!is_over() && dbus().read_write(bus.connection, poll)) {
        while (DBusMessage* const message = dbus().pop_message(bus.connection)) {
            const DialogMessage got(message);
            if (dbus().is_signal(message, "org.freedesktop.portal.Request", "Response")
                && dbus().has_path(message, request.c_str()))
                return path_in(message);
        }
    }
    return {};
}

} // namespace

uintptr_t native_window(GLFWwindow* window) {
    // Not in a GLFW for Wayland.
    using Native = unsigned long (*)(GLFWwindow*);
    const auto native = reinterpret_cast<Native>(::dlsym(RTLD_DEFAULT, "glfwGetX11Window"));
    return native ? native(window) : 0;
}

DialogUpdate ask_system(const DialogJob& job, const std::function<bool()>& is_over) {
    constexpr int patience = 10'000; // milliseconds until the portal has started
    // Without an address libdbus would start a bus.
    const bool has_bus = !core::platform::environment_variable("DBUS_SESSION_BUS_ADDRESS").empty();
    if (!has_bus || !dbus().is_there) return {.is_absent = true};
    const SessionBus bus;
    if (!bus.connection) return {.is_absent = true};
    dbus().bus_add_match(bus.connection, "type='signal',interface='org.freedesktop.portal.Request'",
                         nullptr);
    const DialogMessage call(call_for(job));
    if (!call.message) return {.is_absent = true};
    const DialogMessage reply(
        dbus().send_and_block(bus.connection, call.message, patience, nullptr));
    DBusIter at{};
    if (!reply.message || !dbus().begin_read(reply.message, &at)
        || dbus().type_at(&at) != 'o') // an object path
        return {.is_absent = true};
    const char* request = nullptr;
    dbus().get(&at, static_cast<void*>(&request));
    return {.path = await_answer(bus, request, is_over)};
}

} // namespace app::viewer
