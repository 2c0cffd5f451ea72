// SPDX-License-Identifier: Apache-2.0
#include "fmi/windows_library.hpp"

#include "fmi/windows/wine.hpp"
#include "fmi/windows/wire.hpp"
#include "mebots/assert.hpp"
#include "mebots/input_error.hpp"

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <bit>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <utility>

namespace mebots::master::windows {
namespace {

Process* current = nullptr;  // global, because FMI functions have no argument for it

std::map<std::string, std::string> environment_for(const std::filesystem::path& settings) {
  std::map<std::string, std::string> variables;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string_view text = *entry;
    const auto equals = text.find('=');
    if (equals != std::string_view::npos) variables.emplace(text.substr(0, equals), text.substr(equals + 1));
  }
  variables["WINEPREFIX"] = settings.string();
  variables["WINEDEBUG"] = "-all";
  variables["WINEDLLOVERRIDES"] = "mscoree,mshtml=";  // prevents offers to download .NET and a browser
  variables.erase("DISPLAY");                         // prevents windows
  return variables;
}

/// Ends this process with the signal that Linux sends for the same fault. raise() does not set the code of the signal,
/// by which handlers recognise a fault (isolation/guard.cpp). A process may send itself any code with
/// rt_sigqueueinfo(2).
[[noreturn]] void end_by_fault(int signal, std::uint64_t address) {
  siginfo_t info{};
  info.si_signo = signal;
  info.si_code = SEGV_MAPERR;  // 1, the first code of all these signals
  info.si_addr = std::bit_cast<void*>(address);
  syscall(SYS_rt_sigqueueinfo, getpid(), signal, &info);
  std::signal(signal, SIG_DFL);
  raise(signal);
  _exit(EXIT_FAILURE);
}

/// A structured exception of Windows and the signal of the same fault on Linux.
struct StructuredException {
  std::uint32_t code;
  int signal;
  const char* text;
};

constexpr StructuredException kOther{0, SIGABRT, "structured exception"};
constexpr auto kExceptions = std::to_array<StructuredException>({
    {0xc000'0005, SIGSEGV, "access violation"},
    {0xc000'0006, SIGBUS, "page error"},
    {0xc000'001d, SIGILL, "illegal instruction"},
    {0xc000'0096, SIGILL, "privileged instruction"},
    {0xc000'008d, SIGFPE, "denormal operand"},
    {0xc000'008e, SIGFPE, "division of a floating-point number by zero"},
    {0xc000'008f, SIGFPE, "inexact result"},
    {0xc000'0090, SIGFPE, "invalid floating-point operation"},
    {0xc000'0091, SIGFPE, "floating-point overflow"},
    {0xc000'0093, SIGFPE, "floating-point underflow"},
    {0xc000'0094, SIGFPE, "division of an integer by zero"},
    {0xc000'0095, SIGFPE, "integer overflow"},
    {0xc000'00fd, SIGSEGV, "stack overflow"},
    {0xe06d'7363, SIGABRT, "exception of C++"},
    {0x2047'4343, SIGABRT, "exception of C++"},
});
constexpr std::uint32_t kStackOverflow = 0xc000'00fd;

const StructuredException& exception_of(std::uint32_t code) {
  const auto* const found = std::ranges::find(kExceptions, code, &StructuredException::code);
  return found == kExceptions.end() ? kOther : *found;
}

/// Explains a common error of LoadLibrary.
std::string load_error_text(std::uint32_t code) {
  switch (code) {
    case 126:
      return "it needs a DLL that was not found; `mebots check` lists what it needs";
    case 127:
      return "it needs a function that a DLL lacks";
    case 193:
      return "it is not a library for 64-bit Windows";
    case 1114:
      return "its initialisation failed";
    default:
      return fmt::format("error {} of Windows", code);
  }
}

/// Converts a path to Windows, where wine's drive Z: is the root folder.
std::string windows_path(std::string path) {
  std::ranges::replace(path, '/', '\\');
  return "Z:" + path;
}

/// Converts the location of the resources: a URI before FMI 3.0, a path in FMI 3.0.
std::string windows_place(const std::string& place) {
  constexpr std::string_view kScheme = "file://";
  return place.starts_with(kScheme) ? "file:///Z:" + place.substr(kScheme.size()) : windows_path(place);
}

}  // namespace

/// The process mebots-windows-host.exe under wine, with a pipe for requests and a pipe for replies.
class Process {
 public:
  explicit Process(const std::filesystem::path& settings) {
    MEBOTS_ASSERT(current == nullptr, "one library per process");
    create_wine_settings(settings);
    start(settings);
    current = this;
  }
  ~Process() {
    current = nullptr;
    close(requests_);
    close(replies_);
    waitpid(pid_, nullptr, 0);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  /// Sends a request and waits for its reply. The reply is valid until the next request.
  std::pair<Reply, Reader> request(std::uint32_t function, Writer& arguments) {
    write_all(arguments.frame(function));
    while (true) {
      FrameHeader header;
      read_all(&header, sizeof header);
      received_.resize(header.size);
      read_all(received_.data(), received_.size());
      Reader reader(received_);
      const auto reply = static_cast<Reply>(header.kind);
      if (reply == Reply::exception) end_by_exception(reader);
      if (reply != Reply::log) return {reply, reader};
      log(reader);
    }
  }

  fmi2CallbackLogger fmi2_logger = nullptr;
  fmiCallbackLogger fmi1_logger = nullptr;
  fmi3LogMessageCallback fmi3_logger = nullptr;

 private:
  void start(const std::filesystem::path& settings) {
    std::array<int, 2> to{};
    std::array<int, 2> from{};
    if (pipe2(to.data(), O_CLOEXEC) != 0 || pipe2(from.data(), O_CLOEXEC) != 0)
      throw Error(ErrorCode::system_failure, fmt::format("no pipe: {}", std::strerror(errno)));
    std::signal(SIGPIPE, SIG_IGN);  // the next read detects the end of the process
    requests_ = to[1];
    replies_ = from[0];
    std::vector<std::string> texts{find_wine().program.string(), find_wine().host.string()};
    std::vector<std::string> variables;
    for (const auto& [name, value] : environment_for(settings)) variables.push_back(fmt::format("{}={}", name, value));
    const auto pointers = [](std::vector<std::string>& all) {
      std::vector<char*> found;
      for (auto& text : all) found.push_back(text.data());
      found.push_back(nullptr);
      return found;
    };
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, to[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, from[1], STDOUT_FILENO);
    posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
    const int problem =
        posix_spawn(&pid_, texts[0].c_str(), &actions, nullptr, pointers(texts).data(), pointers(variables).data());
    posix_spawn_file_actions_destroy(&actions);
    close(to[0]);
    close(from[1]);
    if (problem != 0)
      throw Error(ErrorCode::system_failure, fmt::format("{} cannot be started: {}", texts[0], std::strerror(problem)));
  }

  void write_all(std::string_view bytes) {
    while (!bytes.empty()) {
      const auto written = ::write(requests_, bytes.data(), bytes.size());
      if (written < 0 && errno == EINTR) continue;
      if (written < 0) return;  // the next read detects the end of the process
      bytes.remove_prefix(static_cast<std::size_t>(written));
    }
  }

  void read_all(void* data, std::size_t size) {
    auto* place = static_cast<char*>(data);
    while (size > 0) {
      const auto count = ::read(replies_, place, size);
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) end_alike();
      place += count;
      size -= static_cast<std::size_t>(count);
    }
  }

  /// Ends this process with the signal or exit code of the library's process, which must have ended.
  [[noreturn]] void end_alike() {
    int status = 0;
    while (waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    if (WIFSIGNALED(status)) {
      std::signal(WTERMSIG(status), SIG_DFL);
      raise(WTERMSIG(status));
    }
    _exit(WIFEXITED(status) ? WEXITSTATUS(status) : EXIT_FAILURE);
  }

  [[noreturn]] void end_by_exception(Reader& reader) {
    const auto code = reader.get<std::uint32_t>();
    const auto address = reader.get<std::uint64_t>();
    const auto& exception = exception_of(code);
    std::fprintf(stderr, "mebots-fmu-host: the FMU's library for Windows raised exception %#x (%s)\n", code,
                 exception.text);
    const int here = 0;  // an address on the stack, which identifies a stack overflow
    if (exception.signal == SIGABRT) std::abort();
    end_by_fault(exception.signal, code == kStackOverflow ? reinterpret_cast<std::uintptr_t>(&here) : address);
  }

  void log(Reader& reader) const {
    auto* const environment = reader.get<void*>();
    const auto status = reader.get<std::int32_t>();
    const auto instance = reader.get_text();
    const auto category = reader.get_text();
    const auto text = reader.get_text();
    const auto pointer = [](const std::optional<std::string>& value) { return value ? value->c_str() : nullptr; };
    if (fmi1_logger != nullptr) {
      fmi1_logger(environment, pointer(instance), static_cast<fmiStatus>(status), pointer(category), "%s",
                  pointer(text));
    } else if (fmi2_logger != nullptr) {
      fmi2_logger(environment, pointer(instance), static_cast<fmi2Status>(status), pointer(category), "%s",
                  pointer(text));
    } else if (fmi3_logger != nullptr) {
      fmi3_logger(environment, static_cast<fmi3Status>(status), pointer(category), pointer(text));
    }
  }

  pid_t pid_ = -1;
  int requests_ = -1;
  int replies_ = -1;
  std::string received_;
};

namespace {

template <typename Function>
struct SignatureOf;
template <typename Result, typename... Arguments>
struct SignatureOf<Result (*)(Arguments...)> : Signature<Arguments...> {};

// Functions in which an array and its length are not adjacent.
static_assert(SignatureOf<decltype(&fmi2GetDirectionalDerivative)>::length_of(5) == 4);
static_assert(SignatureOf<decltype(&fmi2GetDirectionalDerivative)>::length_of(6) == 2);
static_assert(SignatureOf<decltype(&fmi2SerializedFMUstateSize)>::length_of(2) < 0);
static_assert(SignatureOf<decltype(&fmi2DeSerializeFMUstate)>::length_of(1) == 2);
static_assert(SignatureOf<decltype(&fmi2DeSerializeFMUstate)>::length_of(3) < 0);
static_assert(SignatureOf<decltype(&fmi3GetBinary)>::length_of(3) == 5);
static_assert(SignatureOf<decltype(&fmi3GetOutputDerivatives)>::length_of(3) == 2);
static_assert(SignatureOf<decltype(&fmi3GetIntervalFraction)>::length_of(3) == 2);
static_assert(SignatureOf<decltype(&fmi3DoStep)>::length_of(4) < 0);

/// The index of the argument with the location of the resources; the number of arguments if there is no such argument.
/// Only functions that create an instance have this argument. The types of their callbacks identify them.
template <typename... Arguments>
constexpr std::size_t kPlaceArgument = (std::is_same_v<Arguments, const fmi2CallbackFunctions*> || ...) ? 3
                                       : (std::is_same_v<Arguments, fmi3LogMessageCallback> || ...)     ? 2
                                       : (std::is_same_v<Arguments, fmiCallbackFunctions> || ...)
                                           ? 2
                                           : sizeof...(Arguments);

template <typename... Arguments>
class Sender {
 public:
  using Types = Signature<Arguments...>;

  explicit Sender(const std::tuple<Arguments...>& arguments) : arguments_(&arguments) {}

  template <std::size_t... i>
  void put(Writer& writer, std::index_sequence<i...> /*all*/) const {
    (put_one<i>(writer), ...);
  }
  /// Copies the outputs of a call to the arrays of the caller. `kept` owns the returned texts and bytes until the next
  /// call of the same function.
  template <std::size_t... i>
  void take(Reader& reader, std::array<Slot, sizeof...(Arguments)>& kept, std::index_sequence<i...> /*all*/) const {
    (take_one<i>(reader, kept), ...);
  }

 private:
  template <std::size_t i>
  using Argument = typename Types::template Argument<i>;

  template <std::size_t i>
  std::size_t length() const {
    constexpr int kAt = Types::length_of(i);
    if constexpr (kAt == Types::kSingle)
      return 1;
    else
      return std::get<static_cast<std::size_t>(kAt)>(*arguments_);
  }

  template <std::size_t i>
  void put_one(Writer& writer) const {
    using T = Argument<i>;
    const auto& value = std::get<i>(*arguments_);
    if constexpr (std::is_same_v<T, const fmi2CallbackFunctions*>) {
      current->fmi2_logger = value->logger;
      writer.put(value->componentEnvironment);
    } else if constexpr (std::is_same_v<T, fmiCallbackFunctions>) {
      current->fmi1_logger = value.logger;
    } else if constexpr (std::is_same_v<T, fmi3LogMessageCallback>) {
      current->fmi3_logger = value;
    } else if constexpr (Function<T>) {
      MEBOTS_ASSERT(value == nullptr, "the FMU would call into another process");
    } else if constexpr (Value<T>) {
      writer.put(value);
    } else if constexpr (Text<T, Types::length_of(i)>) {
      if (i == kPlaceArgument<Arguments...> && value != nullptr && *value != '\0')
        writer.put_text(windows_place(value).c_str());
      else
        writer.put_text(value);
    } else {
      put_array<i>(writer, value);
    }
  }

  template <std::size_t i, typename T>
  void put_array(Writer& writer, T values) const {
    const auto count = length<i>();
    writer.put(values == nullptr);
    writer.put(static_cast<std::uint64_t>(count));
    if (values == nullptr) return;
    if constexpr (ArrayOfTexts<T>) {
      for (std::size_t k = 0; InputArray<T> && k < count; ++k) writer.put_text(values[k]);
    } else if constexpr (ArrayOfBytes<T>) {
      const auto* const sizes = std::get<i - 1>(*arguments_);
      for (std::size_t k = 0; InputArray<T> && k < count; ++k) writer.put_binary(values[k], sizes[k]);
    } else {
      writer.put(std::string_view(reinterpret_cast<const char*>(values), count * sizeof(*values)));
    }
  }

  template <std::size_t i>
  void take_one(Reader& reader, std::array<Slot, sizeof...(Arguments)>& kept) const {
    using T = Argument<i>;
    if constexpr (Array<T>) {
      if constexpr (!InputArray<T>) take_array<i>(reader, kept[i], std::get<i>(*arguments_));
    }
  }

  template <std::size_t i, typename T>
  void take_array(Reader& reader, Slot& kept, T values) const {
    const auto count = length<i>();
    if (values == nullptr) return;
    if constexpr (ArrayOfTexts<T> || ArrayOfBytes<T>) {
      std::vector<std::optional<std::string>> texts(count);
      for (auto& text : texts) text = reader.get_text();
      kept.keep_texts<Element<T>>(std::move(texts));
      std::copy_n(kept.as_array<Element<T>>(), count, values);
    } else {
      const auto bytes = reader.get_bytes();
      std::memcpy(values, bytes.data(), std::min(bytes.size(), count * sizeof(*values)));
    }
  }

  const std::tuple<Arguments...>* arguments_;
};

/// An FMI function that sends its calls to the library's process. `member` distinguishes functions of the same type.
template <auto member, typename Pointer>
struct Stub;

template <auto member, typename Table, typename Result, typename... Arguments>
struct Stub<member, Result (*Table::*)(Arguments...)> {
  static inline std::uint32_t number = 0;

  static Result call(Arguments... values) {
    static std::array<Slot, sizeof...(Arguments)> kept;
    static std::string text;
    constexpr std::make_index_sequence<sizeof...(Arguments)> kAll;
    const std::tuple<Arguments...> arguments(values...);
    const Sender<Arguments...> sender(arguments);
    Writer writer;
    sender.put(writer, kAll);
    auto [reply, reader] = current->request(number, writer);
    if constexpr (std::is_same_v<Result, const char*>) {
      auto result = reader.get_text();
      sender.take(reader, kept, kAll);
      text = result.value_or("");
      return result ? text.c_str() : nullptr;
    } else if constexpr (std::is_void_v<Result>) {
      sender.take(reader, kept, kAll);
    } else {
      const auto result = reader.template get<Result>();
      sender.take(reader, kept, kAll);
      return result;
    }
  }
};

/// Returns a table of functions that forward their calls to the process of the library. `exported` contains '\1' for
/// each function that the library exports; all other functions in the table are null.
template <typename Table, typename ForEach>
Table make_table(ForEach for_each_function, std::string_view exported) {
  Table table;
  std::uint32_t number = 0;
  for_each_function([&](const char* /*name*/, auto member, auto /*need*/) {
    using Function = Stub<member(), std::remove_const_t<decltype(member())>>;
    Function::number = number;
    if (number < exported.size() && exported[number] == '\1') table.*member() = &Function::call;
    ++number;
  });
  return table;
}

FmuFunctions make_functions(const modeldesc::ModelDescription& description, std::string_view exported) {
  if (description.is_fmi1())
    return make_table<Fmi1Functions>([](auto action) { fmi1::for_each_function(action); }, exported);
  if (description.is_fmi3())
    return make_table<Fmi3Functions>([](auto action) { fmi3::for_each_function(action); }, exported);
  return make_table<Fmi2Functions>([](auto action) { fmi2::for_each_function(action); }, exported);
}

}  // namespace

WindowsLibrary::WindowsLibrary(const LibraryOwner& owner, const std::filesystem::path& library,
                               const std::filesystem::path& settings)
    : process_(std::make_unique<Process>(settings)) {
  const auto& description = owner.description;
  Writer writer;
  writer.put(static_cast<std::uint32_t>(description.is_fmi1() ? 1 : description.is_fmi3() ? 3 : 2));
  writer.put_text(windows_path(library.string()).c_str());
  writer.put_text(description.is_fmi1() ? (description.co_simulation->model_identifier + "_").c_str() : "");
  auto [reply, reader] = process_->request(kLoad, writer);
  if (reply == Reply::not_found) {
    throw InputError(
        ErrorCode::fmu_inconsistent,
        fmt::format("{}: the FMU's library for Windows, {}, cannot be loaded under wine: {}", owner.archive.string(),
                    library.filename().string(), load_error_text(reader.get<std::uint32_t>())));
  }
  functions_ = make_functions(description, reader.get_bytes());
}

WindowsLibrary::~WindowsLibrary() {
  Writer nothing;
  process_->request(kUnload, nothing);
}

}  // namespace mebots::master::windows
