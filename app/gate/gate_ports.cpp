#include "app/gate/gate_ports.h"

#include <array>
#include <chrono>
#include <exception>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <asio.hpp>
#include <fmt/format.h>

#ifndef _WIN32
#include <cerrno>
#include <cstdlib>

#include <fcntl.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>
#endif

#include "app/gate/gate.h"
#include "core/base/platform.h"

namespace app {
namespace {

using std::chrono::milliseconds;

/// A connection that is read and written without waiting. Its handlers are dropped when it ends.
class Stream {
public:
    virtual ~Stream() = default;
    virtual void write(std::string_view bytes) = 0;

    std::function<void(std::string_view)> on_bytes;
    std::function<void(const std::string& why)> on_end;
};

template <typename Port>
class StreamOf final : public Stream, public std::enable_shared_from_this<StreamOf<Port>> {
public:
    explicit StreamOf(Port port) : port_(std::move(port)) {}

    void start() { read(); }

    void write(std::string_view bytes) override {
        waiting_ += bytes;
        if (writing_.empty()) write_waiting();
    }

private:
    void read() {
        port_.async_read_some(asio::buffer(bytes_), [self = this->shared_from_this()](
                                                        std::error_code error, size_t count) {
            if (error) return self->end(error);
            if (self->on_bytes) self->on_bytes({self->bytes_.data(), count});
            self->read();
        });
    }

    void write_waiting() {
        writing_ = std::exchange(waiting_, {});
        if (writing_.empty()) return;
        asio::async_write(port_, asio::buffer(writing_),
                          [self = this->shared_from_this()](std::error_code error, size_t) {
                              if (error) return self->end(error);
                              self->writing_.clear();
                              self->write_waiting();
                          });
    }

    void end(std::error_code error) {
        on_bytes = {};
        std::error_code ignored;
        port_.close(ignored); // what is not written yet is not for the next one
        if (const auto tell = std::exchange(on_end, {})) tell(error.message());
    }

    Port port_;
    std::array<char, 1024> bytes_{};
    std::string writing_, waiting_;
};

template <typename Port>
std::shared_ptr<StreamOf<Port>> stream_of(Port port) {
    return std::make_shared<StreamOf<Port>>(std::move(port));
}

struct Address {
    std::string host, port;
};

/// The parts of "host:port"; empty if the text is a path.
std::optional<Address> address_in(const std::string& text) {
    const size_t colon = text.rfind(':');
    if (colon == std::string::npos || colon == 0 || colon + 1 == text.size()) return {};
    const std::string port = text.substr(colon + 1);
    if (port.find_first_not_of("0123456789") != std::string::npos) return {};
    return Address{text.substr(0, colon), port};
}

tl::unexpected<core::Error> not_open(const std::string& name, const std::error_code& error) {
    return core::fail(core::ErrorCode::io,
                      fmt::format("{} cannot be opened: {}", name, error.message()));
}

/// The gate with its connections and the thread of its check.
class GateServer {
public:
    GateServer(LineCheck& check, const std::function<bool()>& is_stopped,
               const std::function<void(const std::string&)>& note)
        : check_(check), is_stopped_(is_stopped), note_(note), gate_(links()) {}
    ~GateServer() { close_terminal(); }

    core::Result<void> open_controller(const GatePorts& ports);
    core::Result<void> listen(const std::string& where);
    core::Result<void> open_terminal(const std::string& link);
    core::Result<GateCounts> run();

private:
    Gate::Links links();
    void accept();
    template <typename Port>
    void take_sender(const std::shared_ptr<StreamOf<Port>>& sender);
    void look_at_terminal();
    void empty_terminal();
    void tick();
    void close_terminal();

    LineCheck& check_;
    const std::function<bool()>& is_stopped_;
    const std::function<void(const std::string&)>& note_;
    asio::io_context io_;
    asio::thread_pool checking_{1};
    asio::steady_timer timer_{io_};
    std::optional<asio::ip::tcp::acceptor> acceptor_;
    std::shared_ptr<Stream> controller_, sender_;
    int terminal_ = -1;             // our end
    bool is_terminal_used_ = false; // by the sender
    std::string link_, terminal_name_, failed_;
    Gate gate_;
};

Gate::Links GateServer::links() {
    Gate::Links links;
    links.to_sender = [this](std::string_view bytes) {
        if (sender_) sender_->write(bytes);
    };
    links.to_controller = [this](std::string_view bytes) {
        if (controller_) controller_->write(bytes);
    };
    links.note = note_;
    links.run = [this](std::function<void(LineCheck&)> work, std::function<void()> done) {
        asio::post(checking_, [this, work = std::move(work), done = std::move(done)]() mutable {
            try {
                work(check_);
                asio::post(io_, std::move(done));
            } catch (const std::exception& error) { // no memory: nothing passes any more
                asio::post(io_, [this, why = std::string(error.what())] {
                    failed_ = "a line cannot be checked: " + why;
                    io_.stop();
                });
            }
        });
    };
    return links;
}

core::Result<void> GateServer::open_controller(const GatePorts& ports) {
    const std::string& name = ports.controller;
    std::error_code error;
    const auto begin = [&](const auto& stream) {
        controller_ = stream;
        controller_->on_bytes = [this](std::string_view bytes) { gate_.from_controller(bytes); };
        controller_->on_end = [this](const std::string& why) {
            failed_ = "the controller is gone: " + why;
            io_.stop();
        };
        stream->start();
    };
    if (const auto address = address_in(name)) {
        asio::ip::tcp::resolver resolver(io_);
        asio::ip::tcp::socket socket(io_);
        const auto found = resolver.resolve(address->host, address->port, error);
        if (!error) asio::connect(socket, found, error);
        if (error) return not_open(name, error);
        socket.set_option(asio::ip::tcp::no_delay(true), error);
        begin(stream_of(std::move(socket)));
        return {};
    }
    using Option = asio::serial_port_base;
    asio::serial_port port(io_);
    port.open(name, error);
    if (!error) port.set_option(Option::baud_rate(ports.baud), error);
    if (!error) port.set_option(Option::character_size(8), error);
    if (!error) port.set_option(Option::parity(Option::parity::none), error);
    if (!error) port.set_option(Option::stop_bits(Option::stop_bits::one), error);
    if (!error) port.set_option(Option::flow_control(Option::flow_control::none), error);
#ifndef _WIN32
    // Otherwise another program could open the port, too, and move the machine. Windows has no
    // other way. A pseudoterminal would keep the flag when the gate has ended.
    const char* const terminal = error ? nullptr : ::ttyname(port.native_handle());
    const bool is_real = terminal && !std::string_view(terminal).starts_with("/dev/pts/");
    if (is_real && ::ioctl(port.native_handle(), TIOCEXCL) != 0)
        error = std::error_code(errno, std::generic_category());
#endif
    if (error) return not_open(name, error);
    begin(stream_of(std::move(port)));
    return {};
}

core::Result<void> GateServer::listen(const std::string& where) {
    const auto address = address_in(where);
    if (!address)
        return core::fail(core::ErrorCode::invalid_value,
                          where + " is no address: it has the form 127.0.0.1:2300");
    std::error_code error;
    asio::ip::tcp::resolver resolver(io_);
    const auto found = resolver.resolve(address->host, address->port, error);
    if (error) return not_open(where, error);
    acceptor_.emplace(io_);
    const asio::ip::tcp::endpoint endpoint = *found.begin();
    acceptor_->open(endpoint.protocol(), error);
    if (!error) acceptor_->set_option(asio::socket_base::reuse_address(true), error);
    if (!error) acceptor_->bind(endpoint, error);
    if (!error) acceptor_->listen(asio::socket_base::max_listen_connections, error);
    if (error) return not_open(where, error);
    note_(fmt::format("the sender connects to {}:{}", address->host,
                      acceptor_->local_endpoint().port()));
    accept();
    return {};
}

void GateServer::accept() {
    acceptor_->async_accept([this](std::error_code error, asio::ip::tcp::socket socket) {
        if (error) return;
        std::error_code ignored;
        if (sender_) {
            const std::string text = "[MSG:Feeler: a sender is connected]\r\n";
            asio::write(socket, asio::buffer(text), ignored);
        } else {
            socket.set_option(asio::ip::tcp::no_delay(true), ignored);
            socket.set_option(asio::socket_base::keep_alive(true), ignored);
            take_sender(stream_of(std::move(socket)));
        }
        accept();
    });
}

template <typename Port>
void GateServer::take_sender(const std::shared_ptr<StreamOf<Port>>& sender) {
    sender_ = sender;
    sender->on_bytes = [this](std::string_view bytes) { gate_.from_sender(bytes); };
    sender->on_end = [this](const std::string&) {
        note_("the sender is gone");
        sender_.reset();
        gate_.sender_left();
        if (is_terminal_used_) empty_terminal();
    };
    note_("a sender is connected");
    gate_.sender_came();
    sender->start();
}

#ifdef _WIN32
core::Result<void> GateServer::open_terminal(const std::string&) {
    return core::fail(core::ErrorCode::unsupported,
                      "Windows has no pseudo-terminals: use --listen, or a pair of virtual ports");
}

void GateServer::look_at_terminal() {}
void GateServer::empty_terminal() {}
void GateServer::close_terminal() {}
#else
/// Bytes pass as they are; otherwise ends of lines are doubled, and what is written comes back.
void make_raw(int terminal) {
    termios settings{};
    if (::tcgetattr(terminal, &settings) != 0) return;
    ::cfmakeraw(&settings);
    ::tcsetattr(terminal, TCSANOW, &settings);
}

/// Whether a link is the one of a gate that has ended: to a pseudo-terminal that is no more.
bool leads_to_closed_terminal(const std::string& link) {
    std::error_code error;
    const std::string target = std::filesystem::read_symlink(link, error).string();
    return target.starts_with("/dev/pts/") && !std::filesystem::exists(target, error);
}

core::Result<void> GateServer::open_terminal(const std::string& link) {
    const auto failure = [] { return std::error_code(errno, std::system_category()); };
    terminal_ = ::posix_openpt(O_RDWR | O_NOCTTY);
    if (terminal_ < 0) return not_open(link, failure());
    const bool is_ready = ::grantpt(terminal_) == 0 && ::unlockpt(terminal_) == 0;
    const char* const name = is_ready ? ::ptsname(terminal_) : nullptr;
    // Only after it was opened once does the system say whether somebody has it open.
    const int other_end = name ? ::open(name, O_RDWR | O_NOCTTY) : -1;
    if (other_end < 0) return not_open(link, failure());
    make_raw(other_end);
    ::close(other_end);
    std::error_code error;
    if (std::filesystem::is_symlink(link)) {
        // A gate that was killed leaves its link behind.
        if (!leads_to_closed_terminal(link))
            return core::fail(core::ErrorCode::invalid_value,
                              fmt::format("{} exists already, and another program may use it: "
                                          "choose another name, or remove it",
                                          link));
        std::filesystem::remove(link, error);
    }
    std::filesystem::create_symlink(name, link, error);
    if (error) return not_open(link, error);
    link_ = link;
    terminal_name_ = name;
    note_(fmt::format("the sender opens {} ({})", link, name));
    return {};
}

/// Takes a sender that has opened the terminal. Of all others, only what acts at once counts, such
/// as a feed hold.
void GateServer::look_at_terminal() {
    pollfd state{terminal_, POLLIN, 0};
    if (terminal_ < 0 || is_terminal_used_ || ::poll(&state, 1, 0) < 0) return;
    const bool is_closed = (state.revents & POLLHUP) != 0;
    if (is_closed || sender_) {
        std::array<char, 256> bytes{};
        const ssize_t count =
            (state.revents & POLLIN) != 0 ? ::read(terminal_, bytes.data(), bytes.size()) : 0;
        for (ssize_t i = 0; i < count && !is_closed; ++i)
            if (const char byte = bytes[static_cast<size_t>(i)]; acts_at_once(byte))
                gate_.from_sender({&byte, 1});
        return;
    }
    make_raw(terminal_);
    asio::posix::stream_descriptor port(io_, ::dup(terminal_));
    is_terminal_used_ = true;
    take_sender(stream_of(std::move(port)));
}

/// Drops what the last sender has not read. What the next one has written already stays.
void GateServer::empty_terminal() {
    is_terminal_used_ = false;
    const int other_end = ::open(terminal_name_.c_str(), O_RDWR | O_NOCTTY);
    if (other_end < 0) return;
    ::tcflush(other_end, TCIFLUSH);
    ::close(other_end);
}

void GateServer::close_terminal() {
    std::error_code ignored;
    if (!link_.empty() && std::filesystem::read_symlink(link_, ignored) == terminal_name_)
        std::filesystem::remove(link_, ignored);
    if (terminal_ >= 0) ::close(terminal_);
}
#endif

void GateServer::tick() {
    constexpr auto interval = milliseconds(50);
    if (is_stopped_()) return io_.stop();
    look_at_terminal();
    gate_.tick(core::platform::steady_milliseconds());
    timer_.expires_after(interval); // clock: polls
    timer_.async_wait([this](std::error_code error) {
        if (!error) tick();
    });
}

core::Result<GateCounts> GateServer::run() {
    tick();
    io_.run();
    checking_.stop();
    checking_.join();
    if (!failed_.empty()) return core::fail(core::ErrorCode::io, failed_);
    return GateCounts{gate_.passed(), gate_.refused()};
}

} // namespace

core::Result<GateCounts> run_gate(const GatePorts& ports, LineCheck& check,
                                  const std::function<bool()>& is_stopped,
                                  const std::function<void(const std::string&)>& note) {
    GateServer server(check, is_stopped, note);
    if (auto opened = server.open_controller(ports); !opened) return tl::unexpected(opened.error());
    if (!ports.terminal.empty())
        if (auto opened = server.open_terminal(ports.terminal); !opened)
            return tl::unexpected(opened.error());
    if (!ports.listen.empty())
        if (auto opened = server.listen(ports.listen); !opened)
            return tl::unexpected(opened.error());
    return server.run();
}

} // namespace app
