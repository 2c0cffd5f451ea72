// SPDX-License-Identifier: Apache-2.0
// The program mebots-windows-host.exe, which mebots-fmu-host runs under wine. It loads an FMU's library for Windows and
// calls its functions. It reads requests from standard input and writes replies to standard output. The FMU cannot
// access these two streams.
#include "fmi/windows/wire.hpp"
#include "mebots/fmi1/library.hpp"
#include "mebots/fmi2/library.hpp"
#include "mebots/fmi3/library.hpp"

#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <mutex>

using namespace mebots;
using namespace mebots::master::windows;

namespace {

HANDLE requests = nullptr;
HANDLE replies = nullptr;
std::mutex replies_mutex;  // FMUs may log from their own threads

void write_all(const std::string& frame) {
  const std::lock_guard lock(replies_mutex);
  for (std::size_t done = 0; done < frame.size();) {
    DWORD count = 0;
    if (WriteFile(replies, frame.data() + done, static_cast<DWORD>(frame.size() - done), &count, nullptr) == 0)
      ExitProcess(EXIT_FAILURE);  // the pipe is closed
    done += count;
  }
}

void read_all(void* data, std::size_t size) {
  auto* place = static_cast<char*>(data);
  while (size > 0) {
    DWORD count = 0;
    if (ReadFile(requests, place, static_cast<DWORD>(size), &count, nullptr) == 0 || count == 0)
      ExitProcess(EXIT_FAILURE);
    place += count;
    size -= count;
  }
}

void reply(Reply kind, Writer& writer) {
  write_all(writer.frame(static_cast<std::uint32_t>(kind)));
}

/// Reserves the pipes for this program. Output of the FMU then goes to standard error, and the FMU's standard input is
/// empty.
void move_pipes_aside() {
  const auto process = GetCurrentProcess();
  const auto copy = [&](DWORD which) {
    HANDLE own = nullptr;
    DuplicateHandle(process, GetStdHandle(which), process, &own, 0, FALSE, DUPLICATE_SAME_ACCESS);
    return own;
  };
  requests = copy(STD_INPUT_HANDLE);
  replies = copy(STD_OUTPUT_HANDLE);
  _dup2(_open("NUL", _O_RDONLY), 0);
  _dup2(2, 1);
  // Also redirects the handles of the process. A library that contains its own C library uses them.
  SetStdHandle(STD_INPUT_HANDLE, reinterpret_cast<HANDLE>(_get_osfhandle(0)));
  SetStdHandle(STD_OUTPUT_HANDLE, GetStdHandle(STD_ERROR_HANDLE));
}

LONG WINAPI report_exception(EXCEPTION_POINTERS* pointers) {
  const auto& record = *pointers->ExceptionRecord;
  const bool has_address = record.ExceptionCode == STATUS_ACCESS_VIOLATION && record.NumberParameters > 1;
  struct {
    FrameHeader header;
    std::uint32_t code;
    std::uint32_t address[2];
  } frame{{static_cast<std::uint32_t>(Reply::exception), 12}, record.ExceptionCode, {}};
  const auto address = has_address ? static_cast<std::uint64_t>(record.ExceptionInformation[1])
                                   : reinterpret_cast<std::uint64_t>(record.ExceptionAddress);
  std::memcpy(frame.address, &address, sizeof address);
  DWORD count = 0;
  // Writes without the lock, which this thread may already hold.
  WriteFile(replies, &frame, sizeof frame, &count, nullptr);
  TerminateProcess(GetCurrentProcess(), EXIT_FAILURE);
  return EXCEPTION_EXECUTE_HANDLER;
}

/// Sets the handler of structured exceptions. Must be called again after the library was loaded, because the library
/// may replace the handler.
void catch_exceptions() {
  constexpr ULONG kStackForFilter = 1 << 16;
  ULONG stack = kStackForFilter;
  SetThreadStackGuarantee(&stack);
  SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOGPFAULTERRORBOX | SEM_NOOPENFILEERRORBOX);  // no dialogs
  SetUnhandledExceptionFilter(&report_exception);
}

void send_log(const void* environment, int status, const char* instance, const char* category, const char* text) {
  Writer writer;
  writer.put(reinterpret_cast<std::uint64_t>(environment));
  writer.put(static_cast<std::int32_t>(status));
  writer.put_text(instance);
  writer.put_text(category);
  writer.put_text(text);
  reply(Reply::log, writer);
}

void log_formatted(const void* environment, int status, const char* instance, const char* category, const char* format,
                   std::va_list arguments) {
  if (format == nullptr) return send_log(environment, status, instance, category, nullptr);
  std::va_list copy;
  va_copy(copy, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, copy);
  va_end(copy);
  std::string text(size < 0 ? 0 : static_cast<std::size_t>(size), '\0');
  if (size > 0) std::vsnprintf(text.data(), text.size() + 1, format, arguments);
  send_log(environment, status, instance, category, size < 0 ? format : text.c_str());
}

void log_fmi1(fmiComponent component, fmiString instance, fmiStatus status, fmiString category, fmiString message,
              ...) {
  std::va_list arguments;
  va_start(arguments, message);
  log_formatted(component, status, instance, category, message, arguments);
  va_end(arguments);
}

void log_fmi2(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category,
              fmi2String message, ...) {
  std::va_list arguments;
  va_start(arguments, message);
  log_formatted(environment, status, instance, category, message, arguments);
  va_end(arguments);
}

void log_fmi3(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String message) {
  send_log(environment, status, nullptr, category, message);
}

/// Receives the arguments of a call, calls the function, and sends its outputs. The FMU steps synchronously, because it
/// receives no callback stepFinished.
template <typename... Arguments>
class Receiver {
 public:
  template <std::size_t... i>
  void get(Reader& reader, std::index_sequence<i...> /*all*/) {
    (get_one<i>(reader), ...);
  }
  template <typename Function, std::size_t... i>
  auto call(Function function, std::index_sequence<i...> /*all*/) {
    return function(argument<i>()...);
  }
  template <std::size_t... i>
  void put(Writer& writer, std::index_sequence<i...> /*all*/) {
    (put_one<i>(writer), ...);
  }

 private:
  using Types = Signature<Arguments...>;
  template <std::size_t i>
  using Argument = typename Types::template Argument<i>;

  template <std::size_t i>
  void get_one(Reader& reader) {
    using T = Argument<i>;
    auto& slot = slots_[i];
    if constexpr (std::is_same_v<T, const fmi2CallbackFunctions*>) {
      static std::deque<fmi2CallbackFunctions> all;  // never freed, because an FMU keeps the pointer
      all.push_back({&log_fmi2, &std::calloc, &std::free, nullptr, reader.get<void*>()});
      slot.keep_bytes({reinterpret_cast<const char*>(&all.back()), sizeof all.back()});
      callbacks_ = &all.back();
    } else if constexpr (Function<T> || std::is_same_v<T, fmiCallbackFunctions>) {
      static_cast<void>(slot);
    } else if constexpr (Value<T>) {
      const auto value = reader.get<T>();
      slot.keep_bytes({reinterpret_cast<const char*>(&value), sizeof value});
    } else if constexpr (Text<T, Types::length_of(i)>) {
      slot.texts = {reader.get_text()};
    } else {
      get_array<T>(reader, slot);
    }
  }

  template <typename T>
  void get_array(Reader& reader, Slot& slot) {
    slot.is_null = reader.get<bool>();
    slot.count = reader.get<std::uint64_t>();
    if (slot.is_null) return;
    if constexpr (ArrayOfTexts<T> || ArrayOfBytes<T>) {
      slot.elements.assign(slot.count * sizeof(Element<T>), std::byte{});
      if (!InputArray<T>) return;
      std::vector<std::optional<std::string>> texts(slot.count);
      for (auto& text : texts) text = reader.get_text();
      slot.template keep_texts<Element<T>>(std::move(texts));
    } else {
      slot.keep_bytes(reader.get_bytes());
    }
  }

  template <std::size_t i>
  Argument<i> argument() {
    using T = Argument<i>;
    auto& slot = slots_[i];
    if constexpr (std::is_same_v<T, const fmi2CallbackFunctions*>) {
      return callbacks_;
    } else if constexpr (std::is_same_v<T, fmiCallbackFunctions>) {
      return {&log_fmi1, &std::calloc, &std::free, nullptr};
    } else if constexpr (std::is_same_v<T, fmi3LogMessageCallback>) {
      return &log_fmi3;
    } else if constexpr (Function<T>) {
      return nullptr;
    } else if constexpr (Value<T>) {
      T value;
      std::memcpy(&value, slot.elements.data(), sizeof value);
      return value;
    } else if constexpr (Text<T, Types::length_of(i)>) {
      return slot.texts.front() ? slot.texts.front()->c_str() : nullptr;
    } else {
      return slot.template as_array<std::remove_pointer_t<T>>();
    }
  }

  template <std::size_t i>
  void put_one(Writer& writer) {
    using T = Argument<i>;
    if constexpr (Array<T> && !InputArray<T>) {
      auto& slot = slots_[i];
      if (slot.is_null) return;
      if constexpr (ArrayOfTexts<T>) {
        for (std::uint64_t k = 0; k < slot.count; ++k) writer.put_text(slot.template as_array<const char*>()[k]);
      } else if constexpr (ArrayOfBytes<T>) {
        const auto* const sizes = slots_[i - 1].template as_array<std::size_t>();
        for (std::uint64_t k = 0; k < slot.count; ++k)
          writer.put_binary(slot.template as_array<const std::uint8_t*>()[k], sizes[k]);
      } else {
        writer.put(std::string_view(reinterpret_cast<const char*>(slot.elements.data()), slot.elements.size()));
      }
    }
  }

  std::array<Slot, sizeof...(Arguments)> slots_;
  const fmi2CallbackFunctions* callbacks_ = nullptr;
};

template <typename Result, typename... Arguments>
void serve(Result (*function)(Arguments...), Reader& reader, Writer& writer) {
  constexpr std::make_index_sequence<sizeof...(Arguments)> all;
  Receiver<Arguments...> receiver;
  receiver.get(reader, all);
  if constexpr (std::is_void_v<Result>) {
    receiver.call(function, all);
  } else {
    const auto result = receiver.call(function, all);
    if constexpr (std::is_same_v<Result, const char*>)
      writer.put_text(result);
    else
      writer.put(result);
  }
  receiver.put(writer, all);
}

using Server = std::function<void(Reader&, Writer&)>;

/// Returns a Server for each function of for_each_function(). A Server reads the arguments of a call, calls the
/// function and writes the results. It is empty if the library does not have the function.
template <typename Table, typename ForEach>
std::vector<Server> make_servers(void* library, ForEach for_each_function, const std::string& prefix = {}) {
  const auto table = fmi::find_functions<Table>(library, for_each_function, prefix);
  std::vector<Server> servers;
  for_each_function([&](const char* /*name*/, auto member, auto /*need*/) {
    const auto function = table.*member();
    servers.emplace_back();
    if (function != nullptr)
      servers.back() = [function](Reader& reader, Writer& writer) { serve(function, reader, writer); };
  });
  return servers;
}

std::vector<Server> servers_of(void* library, std::uint32_t version, const std::string& prefix) {
  if (version == 1)
    return make_servers<fmi1::Functions>(
        library, [](auto action) { fmi1::for_each_function(action); }, prefix);
  if (version == 3) return make_servers<fmi3::Functions>(library, [](auto action) { fmi3::for_each_function(action); });
  return make_servers<fmi2::Functions>(library, [](auto action) { fmi2::for_each_function(action); });
}

std::wstring wide(const std::string& text) {
  const auto size = static_cast<int>(text.size());
  std::wstring converted(static_cast<std::size_t>(MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0)), 0);
  MultiByteToWideChar(CP_UTF8, 0, text.data(), size, converted.data(), static_cast<int>(converted.size()));
  return converted;
}

class Host {
 public:
  /// Executes requests until the library is unloaded.
  void run() {
    std::string received;
    while (true) {
      FrameHeader header;
      read_all(&header, sizeof header);
      received.resize(header.size);
      read_all(received.data(), received.size());
      Reader reader(received);
      writer_.clear();
      if (header.kind == kLoad) {
        load(reader);
        continue;
      }
      if (header.kind == kUnload)
        FreeLibrary(library_);
      else
        servers_.at(header.kind)(reader, writer_);
      std::fflush(nullptr);
      reply(Reply::result, writer_);
      if (header.kind == kUnload) return;
    }
  }

 private:
  void load(Reader& reader) {
    const auto version = reader.get<std::uint32_t>();
    const auto path = wide(reader.get_text().value());
    const auto prefix = reader.get_text().value();
    // FMUs may expect that the folder of their library is the current folder and on the search path.
    const auto folder = path.substr(0, path.rfind(L'\\'));
    SetCurrentDirectoryW(folder.c_str());
    library_ = LoadLibraryExW(path.c_str(), nullptr, LOAD_WITH_ALTERED_SEARCH_PATH);
    const auto problem = GetLastError();
    catch_exceptions();
    if (library_ == nullptr) {
      writer_.put(static_cast<std::uint32_t>(problem));
      return reply(Reply::not_found, writer_);
    }
    servers_ = servers_of(library_, version, prefix);
    std::string exported;
    for (const auto& server : servers_) exported += server ? '\1' : '\0';
    writer_.put(std::string_view(exported));
    reply(Reply::result, writer_);
  }

  HMODULE library_ = nullptr;
  std::vector<Server> servers_;
  Writer writer_;
};

}  // namespace

int main() {
  move_pipes_aside();
  catch_exceptions();
  try {
    Host().run();
  } catch (const std::exception& error) {
    std::fprintf(stderr, "mebots-windows-host.exe: %s\n", error.what());
    return EXIT_FAILURE;
  }
  ExitProcess(EXIT_SUCCESS);
}
