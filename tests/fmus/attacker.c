// SPDX-License-Identifier: Apache-2.0
// An FMU that attacks the user who runs it. Each attack tries to access something outside of the FMU. If it succeeds,
// it undoes its effect. `targets` lists the targets that the test has set up: "key=value;key=value". After the first
// step, `report` has a line per attack: "name<tab>reached|held<tab>what it tries".
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif

#include "fmi2.h"

#include "frame.h"

#include <arpa/inet.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/keyctl.h>
#include <mqueue.h>
#include <net/if.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/ipc.h>
#include <sys/klog.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/msg.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/reboot.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/swap.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>
#include <sys/time.h>
#include <sys/timex.h>
#include <sys/uio.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <sys/xattr.h>
#include <time.h>
#include <unistd.h>

enum { TEXT = 1 << 15, PATH = 512 };

typedef struct {
  char targets[TEXT];
  char report[TEXT];
} Model;

static const char* all_targets;
static char own_folder[512];

/// Returns the value of a key in `targets`; empty if the key is missing. The text is valid during the next three calls.
static const char* target(const char* key) {
  static char values[4][PATH];
  static int turn;
  char* value = values[turn++ % 4];
  const size_t length = strlen(key);
  value[0] = '\0';
  for (const char* at = all_targets; at != NULL && *at != '\0'; at = strchr(at, ';') ? strchr(at, ';') + 1 : NULL) {
    if (strncmp(at, key, length) != 0 || at[length] != '=') continue;
    snprintf(value, PATH, "%.*s", (int)strcspn(at + length + 1, ";"), at + length + 1);
  }
  return value;
}

static const char* in_home(const char* name) {
  static char path[2 * PATH];
  snprintf(path, sizeof path, "%s/%s", target("home"), name);
  return path;
}

static pid_t victim(void) {
  return (pid_t)atoi(target("process"));
}

/// Returns true if a file can be opened. Closes the file.
static int opens(const char* path, int flags) {
  const int file = open(path, flags | O_CLOEXEC, 0600);
  if (file >= 0) close(file);
  return file >= 0;
}

static int has_content(const char* path) {
  char byte;
  const int file = open(path, O_RDONLY | O_CLOEXEC);
  const int has = file >= 0 && read(file, &byte, 1) == 1;
  if (file >= 0) close(file);
  return has;
}

static int process_file(const char* name, int flags) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%d/%s", (int)victim(), name);
  return flags == O_RDONLY ? has_content(path) : opens(path, flags);
}

// Attacks on files.
static int read_private_file(void) {
  return has_content(in_home("private.txt"));
}
static int read_public_file(void) {
  return has_content(in_home("public.txt"));
}
static int list_home(void) {
  DIR* folder = opendir(target("home"));
  if (folder != NULL) closedir(folder);
  return folder != NULL;
}
static int find_file(void) {
  struct stat status;
  return stat(in_home("private.txt"), &status) == 0;
}
static int create_file(void) {
  const int done = opens(in_home("created.txt"), O_WRONLY | O_CREAT);
  unlink(in_home("created.txt"));
  return done;
}
static int write_file(void) {
  return opens(in_home("public.txt"), O_WRONLY | O_APPEND);
}
static int truncate_file(void) {
  return truncate(in_home("truncated.txt"), 0) == 0;
}
static int delete_file(void) {
  return unlink(in_home("deleted.txt")) == 0;
}
static int rename_file(void) {
  char other[2 * PATH];
  snprintf(other, sizeof other, "%s", in_home("renamed.txt"));
  return rename(in_home("renamable.txt"), other) == 0;
}
static int change_mode(void) {
  return chmod(in_home("private.txt"), 0666) == 0;
}
static int change_mode_at(void) {
  return fchmodat(AT_FDCWD, in_home("private.txt"), 0666, 0) == 0;
}
static int change_times(void) {
  const struct timespec times[2] = {{1, 0}, {1, 0}};
  return utimensat(AT_FDCWD, in_home("public.txt"), times, 0) == 0;
}
static int change_owner(void) {
  return chown(in_home("public.txt"), getuid(), getgid()) == 0;
}
static int set_attribute(void) {
  return setxattr(in_home("public.txt"), "user.attack", "x", 1, 0) == 0;
}
static int make_folder(void) {
  const int done = mkdir(in_home("folder"), 0700) == 0;
  if (done) rmdir(in_home("folder"));
  return done;
}
static int make_link(void) {
  const int done = symlink("/", in_home("link")) == 0;
  if (done) unlink(in_home("link"));
  return done;
}
static int link_secret(void) {
  const int done = link(in_home("private.txt"), "/tmp/attacker-link") == 0;
  if (done) unlink("/tmp/attacker-link");
  return done;
}
static int read_passwords(void) {
  return has_content("/etc/shadow");
}
static int read_users(void) {
  return has_content("/etc/passwd");
}
static int read_machine_id(void) {
  return has_content("/etc/machine-id");
}
static int write_system(void) {
  const int done = opens("/usr/attacker", O_WRONLY | O_CREAT);
  if (done) unlink("/usr/attacker");
  return done;
}
static int write_temporary(void) {  // the test looks for the file
  return opens(target("temporary"), O_WRONLY | O_CREAT) && strcmp(target("looks"), "inside") == 0;
}
static int read_temporary(void) {
  return has_content(target("temporary_file"));
}
static int write_own_folder(void) {
  char path[2 * PATH];
  snprintf(path, sizeof path, "%s/attacker", own_folder);
  const int done = opens(path, O_WRONLY | O_CREAT);
  unlink(path);
  return done;
}
static int read_shared_memory(void) {
  return has_content(target("shared_memory"));
}
static int list_shared_memory(void) {
  char path[PATH];
  snprintf(path, sizeof path, "%s", target("shared_memory"));
  return access(path, F_OK) == 0;
}
static int write_shared_memory(void) {
  return opens(target("shared_memory"), O_RDWR);
}
static int open_by_handle(void) {
  enum { SIZE = 128 };
  uint64_t bytes[(sizeof(struct file_handle) + SIZE) / sizeof(uint64_t)] = {0};
  struct file_handle* handle = (struct file_handle*)bytes;
  handle->handle_bytes = SIZE;
  int mount_number = 0;
  if (name_to_handle_at(AT_FDCWD, "/usr", handle, &mount_number, 0) != 0) return 0;
  const int folder = open("/usr", O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int file = open_by_handle_at(folder, handle, O_RDONLY);
  if (file >= 0) close(file);
  close(folder);
  return file >= 0;
}

// Attacks on devices.
static int open_memory(void) {
  return opens("/dev/mem", O_RDONLY);
}
static int open_kernel_log(void) {
  return opens("/dev/kmsg", O_RDONLY);
}
static int open_terminal(void) {
  return opens("/dev/tty", O_RDWR);
}
static int open_disk(void) {
  return opens("/dev/sda", O_RDONLY) || opens("/dev/vda", O_RDONLY) || opens("/dev/nvme0n1", O_RDONLY);
}
static int open_fuse(void) {
  return opens("/dev/fuse", O_RDWR);
}
static int make_device(void) {
  char path[PATH];
  snprintf(path, sizeof path, "%s/attacker-device", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  if (mknod(path, S_IFBLK | 0600, makedev(8, 0)) != 0) return 0;
  const int done = opens(path, O_RDONLY);
  unlink(path);
  return done;
}
static int type_into_terminal(void) {
  char letter = ' ';
  return ioctl(STDERR_FILENO, TIOCSTI, &letter) == 0;
}
static int list_devices(void) {
  return access("/sys/class", R_OK) == 0;
}

// Attacks on memory and messages between processes.
static int attach_segment(void) {
  const int segment = shmget((key_t)atoi(target("key")), 0, 0);
  return segment >= 0;
}
static int open_semaphore(void) {
  return semget((key_t)atoi(target("key")), 0, 0) >= 0;
}
static int open_messages(void) {
  return msgget((key_t)atoi(target("key")), 0) >= 0;
}
static int open_queue(void) {
  const long queue = syscall(SYS_mq_open, "attacker", O_RDWR | O_CREAT, 0600, NULL);
  if (queue >= 0) syscall(SYS_mq_unlink, "attacker"), close((int)queue);
  return queue >= 0;
}

// Attacks through sockets.
static int reaches(int family, int type, const void* address, socklen_t size) {
  const int line = socket(family, type | SOCK_CLOEXEC, 0);
  const int done = line >= 0 && connect(line, address, size) == 0;
  if (line >= 0) close(line);
  return done;
}
static int connect_by_path(void) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  snprintf(address.sun_path, sizeof address.sun_path, "%s", target("socket"));
  return reaches(AF_UNIX, SOCK_STREAM, &address, sizeof address);
}
static int connect_abstract(void) {
  struct sockaddr_un address = {.sun_family = AF_UNIX};
  const int length = snprintf(address.sun_path + 1, sizeof address.sun_path - 1, "%s", target("abstract"));
  return reaches(AF_UNIX, SOCK_STREAM, &address, (socklen_t)(offsetof(struct sockaddr_un, sun_path) + 1 + length));
}
static int connect_tcp(void) {
  const struct sockaddr_in address = {
      .sin_family = AF_INET, .sin_port = htons((uint16_t)atoi(target("port"))), .sin_addr = {htonl(INADDR_LOOPBACK)}};
  return reaches(AF_INET, SOCK_STREAM, &address, sizeof address);
}
static int connect_tcp6(void) {
  const struct sockaddr_in6 address = {
      .sin6_family = AF_INET6, .sin6_port = htons((uint16_t)atoi(target("port6"))), .sin6_addr = in6addr_loopback};
  return reaches(AF_INET6, SOCK_STREAM, &address, sizeof address);
}
static int send_udp(void) {
  const struct sockaddr_in address = {.sin_family = AF_INET,
                                      .sin_port = htons((uint16_t)atoi(target("port_udp"))),
                                      .sin_addr = {htonl(INADDR_LOOPBACK)}};
  return reaches(AF_INET, SOCK_DGRAM, &address, sizeof address) && strcmp(target("looks"), "inside") == 0;
}
static int listen_tcp(void) {
  const struct sockaddr_in address = {.sin_family = AF_INET,
                                      .sin_port = htons((uint16_t)atoi(target("free_port"))),
                                      .sin_addr = {htonl(INADDR_LOOPBACK)}};
  const int line = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const int done = line >= 0 && bind(line, (const struct sockaddr*)&address, sizeof address) == 0;
  if (line >= 0) close(line);
  return done && strcmp(target("looks"), "inside") == 0;
}
static int makes_socket(int family, int type) {
  const int line = socket(family, type | SOCK_CLOEXEC, 0);
  if (line >= 0) close(line);
  return line >= 0;
}
static int socket_vsock(void) {
  return makes_socket(AF_VSOCK, SOCK_STREAM);
}
static int socket_packet(void) {
  return makes_socket(AF_PACKET, SOCK_RAW);
}
static int socket_raw(void) {
  const int line = socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, IPPROTO_ICMP);
  if (line >= 0) close(line);
  return line >= 0;
}
static int socket_netlink(void) {
  return makes_socket(AF_NETLINK, SOCK_RAW);
}
static int socket_crypto(void) {
  return makes_socket(AF_ALG, SOCK_SEQPACKET);
}
static int socket_bluetooth(void) {
  return makes_socket(AF_BLUETOOTH, SOCK_STREAM);
}
static int list_interfaces(void) {
  const int line = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  struct ifreq request = {.ifr_ifindex = 2};
  const int done = line >= 0 && ioctl(line, SIOCGIFNAME, &request) == 0;
  if (line >= 0) close(line);
  return done;
}

// Attacks on other processes.
static int read_arguments(void) {
  return process_file("cmdline", O_RDONLY);
}
static int read_environment(void) {
  return process_file("environ", O_RDONLY);
}
static int read_master_environment(void) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%s/environ", target("master"));
  return has_content(path) && atoi(target("master")) != getpid();
}
static int read_status(void) {
  return process_file("status", O_RDONLY);
}
static int read_maps(void) {
  return process_file("maps", O_RDONLY);
}
static int list_descriptors(void) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%d/fd", (int)victim());
  DIR* folder = opendir(path);
  if (folder != NULL) closedir(folder);
  return folder != NULL;
}
static int follow_root(void) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%d/root/%s", (int)victim(), in_home("private.txt"));
  return has_content(path);
}
static int open_its_memory(void) {
  return process_file("mem", O_RDWR);
}
static int send_signal(void) {
  return kill(victim(), SIGUSR2) == 0;
}
static int send_null_signal(void) {
  return kill(victim(), 0) == 0;
}
static int signal_thread(void) {
  return syscall(SYS_tgkill, victim(), victim(), SIGUSR2) == 0;
}
static int queue_signal(void) {
  siginfo_t info = {.si_signo = SIGUSR2, .si_code = SI_QUEUE};
  return syscall(SYS_rt_sigqueueinfo, victim(), SIGUSR2, &info) == 0;
}
static int open_process(void) {
  const long process = syscall(SYS_pidfd_open, victim(), 0);
  if (process >= 0) close((int)process);
  return process >= 0;
}
static int owner_signal(void) {
  return fcntl(STDIN_FILENO, F_SETOWN, victim()) == 0;
}
static int trace_process(void) {
  const int done = ptrace(PTRACE_SEIZE, victim(), 0, 0) == 0;
  if (done) ptrace(PTRACE_DETACH, victim(), 0, 0);
  return done;
}
static int read_memory(void) {
  char byte = 0;
  const struct iovec to = {&byte, 1};
  const struct iovec from = {(void*)(uintptr_t)strtoull(target("address"), NULL, 16), 1};
  return process_vm_readv(victim(), &to, 1, &from, 1, 0) == 1;
}
static int change_limit(void) {
  struct rlimit limit;
  return prlimit(victim(), RLIMIT_CORE, NULL, &limit) == 0;
}
static int change_priority(void) {
  return setpriority(PRIO_PROCESS, (id_t)victim(), 1) == 0;
}
static int change_affinity(void) {
  cpu_set_t processors;
  if (sched_getaffinity(victim(), sizeof processors, &processors) != 0) return 0;
  return sched_setaffinity(victim(), sizeof processors, &processors) == 0;
}
static int compare_process(void) {
  return syscall(SYS_kcmp, getpid(), victim(), 1, 0, 0) >= 0;
}
static int advise_memory(void) {
  const long process = syscall(SYS_pidfd_open, victim(), 0);
  const struct iovec none = {NULL, 0};
  const int done = process >= 0 && syscall(SYS_process_madvise, process, &none, 1, 20, 0) >= 0;
  if (process >= 0) close((int)process);
  return done;
}
static int raise_memory_score(void) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%d/oom_score_adj", (int)victim());
  return opens(path, O_WRONLY);
}
static int join_namespace(void) {
  char path[PATH];
  snprintf(path, sizeof path, "/proc/%d/ns/net", (int)victim());
  const int space = open(path, O_RDONLY | O_CLOEXEC);
  if (space >= 0) close(space);
  return space >= 0;
}

// Attacks on secrets and rights.
static int read_variable(void) {
  return getenv("MEBOTS_TEST_SECRET") != NULL;
}
static int add_key(void) {
  return syscall(SYS_add_key, "user", "attacker", "x", 1, KEY_SPEC_SESSION_KEYRING) >= 0;
}
static int read_keyring(void) {
  return syscall(SYS_keyctl, KEYCTL_GET_KEYRING_ID, KEY_SPEC_SESSION_KEYRING, 0) >= 0;
}
static int request_key(void) {
  return syscall(SYS_request_key, "user", "attacker", NULL, 0) >= 0;
}
static int gain_rights(void) {
  return prctl(PR_GET_NO_NEW_PRIVS, 0, 0, 0, 0) == 0;
}
static int become_root(void) {
  return setresuid(0, 0, 0) == 0;
}
static int new_user_namespace(void) {
  return unshare(CLONE_NEWUSER) == 0;
}
static int new_mount_namespace(void) {
  return unshare(CLONE_NEWNS) == 0;
}
static int clone_namespace(void) {
  const long child = syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, 0, 0, 0, 0);
  if (child == 0) _exit(0);
  if (child > 0) waitpid((pid_t)child, NULL, 0);
  return child > 0;
}
static int mount_tmpfs(void) {
  const int done = mount("none", "/mnt", "tmpfs", 0, NULL) == 0;
  if (done) umount("/mnt");
  return done;
}
static int new_mount_api(void) {
  const long context = syscall(SYS_fsopen, "tmpfs", 0);
  if (context >= 0) close((int)context);
  return context >= 0;
}
static int clone_mount(void) {
  const long tree = syscall(SYS_open_tree, AT_FDCWD, "/", 1 /* OPEN_TREE_CLONE */);
  if (tree >= 0) close((int)tree);
  return tree >= 0;
}
static int unmount_proc(void) {
  return umount2("/dev/shm", 8 /* UMOUNT_NOFOLLOW */) == 0;
}
static int change_root(void) {
  return chroot("/usr") == 0;
}

// Attacks on the kernel.
static int load_bpf(void) {
  char attributes[128] = {1, 0, 0, 0, 4, 0, 0, 0, 4, 0, 0, 0, 1};  // a map: hash, key 4, value 4, one entry
  const long map = syscall(SYS_bpf, 0, attributes, sizeof attributes);
  if (map >= 0) close((int)map);
  return map >= 0;
}
static int use_userfaultfd(void) {
  const long file = syscall(SYS_userfaultfd, O_CLOEXEC | 1 /* UFFD_USER_MODE_ONLY */);
  if (file >= 0) close((int)file);
  return file >= 0;
}
static int use_io_uring(void) {
  char parameters[120] = {0};
  const long ring = syscall(SYS_io_uring_setup, 1, parameters);
  if (ring >= 0) close((int)ring);
  return ring >= 0;
}
static int use_perf(void) {
  char attributes[128] = {1, 0, 0, 0, 112, 0, 0, 0};  // software event, its version 5
  attributes[40] = 0x60;                              // without kernel and hypervisor
  const long event = syscall(SYS_perf_event_open, attributes, 0, -1, -1, 0);
  if (event >= 0) close((int)event);
  return event >= 0;
}
static int set_clock(void) {
  struct timespec now;
  return clock_gettime(CLOCK_REALTIME, &now) == 0 && clock_settime(CLOCK_REALTIME, &now) == 0;
}
static int adjust_clock(void) {
  struct timex change = {.modes = ADJ_TICK, .tick = 10000};
  return adjtimex(&change) >= 0;
}
static int set_host_name(void) {
  return sethostname("sandbox", 7) == 0;
}
static int read_kernel_log(void) {
  char text[64];
  return klogctl(3 /* read all */, text, sizeof text) > 0;
}
static int write_setting(void) {
  return opens("/proc/sys/kernel/core_pattern", O_WRONLY);
}
static int press_sysrq(void) {
  return opens("/proc/sysrq-trigger", O_WRONLY);
}
static int turn_swap_off(void) {
  return swapoff("/attacker") == 0 || errno == ENOENT;
}
static int prepare_reboot(void) {
  return reboot(RB_DISABLE_CAD) == 0;
}
static int load_module(void) {
  return syscall(SYS_init_module, "", 0, "") == 0 || errno == ENOEXEC;
}
static int no_randomisation(void) {
  const int before = (int)syscall(SYS_personality, 0xffffffff);
  const int done = syscall(SYS_personality, before | 0x0040000) >= 0;
  if (done) syscall(SYS_personality, before);
  return done;
}
static int watch_files(void) {
  const long group = syscall(SYS_fanotify_init, 0, O_RDONLY);
  if (group >= 0) close((int)group);
  return group >= 0;
}

// Attacks that exhaust resources.
static int many_processes(void) {
  enum { MANY = 1000 };
  static pid_t children[MANY];
  int count = 0;
  for (; count < MANY; ++count) {
    const pid_t child = fork();
    if (child < 0) break;
    if (child == 0) {
      for (;;) pause();
    }
    children[count] = child;
  }
  for (int i = 0; i < count; ++i) kill(children[i], SIGKILL), waitpid(children[i], NULL, 0);
  return count == MANY;
}
static int many_files(void) {
  enum { MANY = 2000 };
  struct rlimit limit;
  if (getrlimit(RLIMIT_NOFILE, &limit) == 0) {
    limit.rlim_cur = limit.rlim_max;
    setrlimit(RLIMIT_NOFILE, &limit);
  }
  static int files[MANY];
  int count = 0;
  while (count < MANY && (files[count] = open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0) ++count;
  for (int i = 0; i < count; ++i) close(files[i]);
  return count == MANY;
}
static int large_file(void) {
  char path[PATH];
  snprintf(path, sizeof path, "%s/attacker-large", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp");
  const int file = open(path, O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  signal(SIGXFSZ, SIG_IGN);
  const int done = file >= 0 && fallocate(file, 0, 0, (off_t)2 << 30) == 0;
  signal(SIGXFSZ, SIG_DFL);
  if (file >= 0) close(file);
  unlink(path);
  return done;
}
static int much_memory(void) {
  const size_t size = (size_t)64 << 30;
  void* memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (memory != MAP_FAILED) munmap(memory, size);
  return memory != MAP_FAILED;
}
static int real_time(void) {
  const struct sched_param parameters = {.sched_priority = 1};
  const int done = sched_setscheduler(0, SCHED_FIFO, &parameters) == 0;
  const struct sched_param none = {0};
  if (done) sched_setscheduler(0, SCHED_OTHER, &none);
  return done;
}

typedef struct {
  const char* name;
  int (*reach)(void);
  const char* text;
} Attack;

#define ATTACK(name, text) \
  { #name, &name, text }
static const Attack attacks[] = {
    ATTACK(read_private_file, "read a file of the user (mode 0600)"),
    ATTACK(read_public_file, "read a file in the user's home that all may read"),
    ATTACK(list_home, "list the user's home"),
    ATTACK(find_file, "learn size and times of a file"),
    ATTACK(create_file, "create a file in the user's home"),
    ATTACK(write_file, "append to a file of the user"),
    ATTACK(truncate_file, "truncate a file of the user"),
    ATTACK(delete_file, "delete a file of the user"),
    ATTACK(rename_file, "rename a file of the user"),
    ATTACK(change_mode, "change the mode of a file from 600 to 666 (chmod)"),
    ATTACK(change_mode_at, "the same by fchmodat"),
    ATTACK(change_times, "change the times of a file"),
    ATTACK(change_owner, "change the owner of a file"),
    ATTACK(set_attribute, "set an extended attribute of a file"),
    ATTACK(make_folder, "make a folder in the user's home"),
    ATTACK(make_link, "make a symbolic link in the user's home"),
    ATTACK(link_secret, "link a file of the user to /tmp"),
    ATTACK(read_passwords, "read /etc/shadow"),
    ATTACK(read_users, "read /etc/passwd"),
    ATTACK(read_machine_id, "read /etc/machine-id"),
    ATTACK(write_system, "write below /usr"),
    ATTACK(write_temporary, "leave a file in the system's /tmp"),
    ATTACK(read_temporary, "read another program's file in /tmp"),
    ATTACK(write_own_folder, "write into its own unpacked folder"),
    ATTACK(read_shared_memory, "read a file of mode 0600 in /dev/shm"),
    ATTACK(list_shared_memory, "find a file in /dev/shm"),
    ATTACK(write_shared_memory, "write a file in /dev/shm"),
    ATTACK(open_by_handle, "open a file by its handle"),
    ATTACK(open_memory, "open /dev/mem"),
    ATTACK(open_kernel_log, "open /dev/kmsg"),
    ATTACK(open_terminal, "open the terminal (/dev/tty)"),
    ATTACK(open_disk, "open a disk"),
    ATTACK(open_fuse, "open /dev/fuse"),
    ATTACK(make_device, "make a device node and open it"),
    ATTACK(type_into_terminal, "type into the terminal (TIOCSTI)"),
    ATTACK(list_devices, "list devices in /sys"),
    ATTACK(attach_segment, "find a segment of System V memory"),
    ATTACK(open_semaphore, "find a System V semaphore"),
    ATTACK(open_messages, "find a System V message queue"),
    ATTACK(open_queue, "open a POSIX message queue"),
    ATTACK(connect_by_path, "connect to a Unix socket by its path, such as the socket of ssh-agent, D-Bus or Docker"),
    ATTACK(connect_abstract, "connect to an abstract Unix socket"),
    ATTACK(connect_tcp, "connect to a TCP port of this machine (IPv4)"),
    ATTACK(connect_tcp6, "the same (IPv6)"),
    ATTACK(send_udp, "send a UDP packet to this machine"),
    ATTACK(listen_tcp, "listen on a TCP port"),
    ATTACK(socket_vsock, "create an AF_VSOCK socket"),
    ATTACK(socket_packet, "create an AF_PACKET socket"),
    ATTACK(socket_raw, "create a raw socket"),
    ATTACK(socket_netlink, "create an AF_NETLINK socket"),
    ATTACK(socket_crypto, "create an AF_ALG socket"),
    ATTACK(socket_bluetooth, "create an AF_BLUETOOTH socket"),
    ATTACK(list_interfaces, "list network interfaces"),
    ATTACK(read_arguments, "read the command line of another process"),
    ATTACK(read_environment, "read the environment of another process"),
    ATTACK(read_master_environment, "read the environment of the master"),
    ATTACK(read_status, "read the status of another process"),
    ATTACK(read_maps, "read the memory map of another process"),
    ATTACK(list_descriptors, "list open files of another process"),
    ATTACK(follow_root, "read a file through /proc/PID/root"),
    ATTACK(open_its_memory, "open /proc/PID/mem of another process"),
    ATTACK(send_signal, "send a signal to another process (kill)"),
    ATTACK(send_null_signal, "test whether another process exists (kill with signal 0)"),
    ATTACK(signal_thread, "send a signal by tgkill"),
    ATTACK(queue_signal, "send a signal by rt_sigqueueinfo"),
    ATTACK(open_process, "open another process (pidfd_open)"),
    ATTACK(owner_signal, "let the kernel send signals (F_SETOWN)"),
    ATTACK(trace_process, "trace another process (ptrace)"),
    ATTACK(read_memory, "read memory of another process (process_vm_readv)"),
    ATTACK(change_limit, "read limits of another process (prlimit)"),
    ATTACK(change_priority, "change the priority of another process"),
    ATTACK(change_affinity, "change the affinity of another process"),
    ATTACK(compare_process, "compare kernel objects with another process (kcmp)"),
    ATTACK(advise_memory, "advise the kernel about memory of another process (process_madvise)"),
    ATTACK(raise_memory_score, "change which process the kernel ends for lack of memory"),
    ATTACK(join_namespace, "open a namespace of another process"),
    ATTACK(read_variable, "read a secret from the environment"),
    ATTACK(add_key, "add a key to the session's keyring"),
    ATTACK(read_keyring, "find the session's keyring"),
    ATTACK(request_key, "request a key"),
    ATTACK(gain_rights, "gain rights by a set-user-ID program (no_new_privs is off)"),
    ATTACK(become_root, "become root (setresuid)"),
    ATTACK(new_user_namespace, "make a user namespace (unshare)"),
    ATTACK(new_mount_namespace, "make a mount namespace (unshare)"),
    ATTACK(clone_namespace, "make a user namespace (clone)"),
    ATTACK(mount_tmpfs, "mount a file system"),
    ATTACK(new_mount_api, "prepare a mount (fsopen)"),
    ATTACK(clone_mount, "clone a mount (open_tree)"),
    ATTACK(unmount_proc, "unmount a file system"),
    ATTACK(change_root, "change its root folder (chroot)"),
    ATTACK(load_bpf, "load a BPF map"),
    ATTACK(use_userfaultfd, "use userfaultfd"),
    ATTACK(use_io_uring, "use io_uring"),
    ATTACK(use_perf, "use perf events"),
    ATTACK(set_clock, "set the clock"),
    ATTACK(adjust_clock, "adjust the clock (adjtimex)"),
    ATTACK(set_host_name, "set the host name"),
    ATTACK(read_kernel_log, "read the kernel's log (syslog)"),
    ATTACK(write_setting, "open /proc/sys/kernel/core_pattern to write"),
    ATTACK(press_sysrq, "open /proc/sysrq-trigger to write"),
    ATTACK(turn_swap_off, "turn swap off"),
    ATTACK(prepare_reboot, "change what Ctrl-Alt-Del does (reboot)"),
    ATTACK(load_module, "load a kernel module"),
    ATTACK(no_randomisation, "turn off address randomisation (personality)"),
    ATTACK(watch_files, "watch files of all processes (fanotify)"),
    ATTACK(many_processes, "start 1,000 processes"),
    ATTACK(many_files, "open 2,000 files"),
    ATTACK(large_file, "allocate a file of 2 GiB"),
    ATTACK(much_memory, "map 64 GiB of memory"),
    ATTACK(real_time, "take real-time priority"),
};

/// Runs an attack in a separate process, so that its effects on the process end with this process.
static int reached_by_child(int (*reach)(void)) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(20);
    _exit(reach() ? 1 : 0);
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 1;
}

static void attack_all(Model* m) {
  all_targets = m->targets;
  size_t used = 0;
  for (size_t i = 0; i < sizeof attacks / sizeof attacks[0]; ++i) {
    const int reached = reached_by_child(attacks[i].reach);
    used += (size_t)snprintf(m->report + used, sizeof m->report - used, "%s\t%s\t%s\n", attacks[i].name,
                             reached ? "reached" : "held", attacks[i].text);
  }
}

FMI2_VERSIONS

FMI2_EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources,
                                          const fmi2CallbackFunctions* callbacks, fmi2Boolean visible,
                                          fmi2Boolean logging) {
  (void)name, (void)type, (void)guid, (void)callbacks, (void)visible, (void)logging;
  const char* path = strncmp(resources, "file://", 7) == 0 ? resources + 7 : resources;
  snprintf(own_folder, sizeof own_folder, "%s", path);
  char* last = strstr(own_folder, "/resources");
  if (last != NULL) *last = '\0';
  return calloc(1, sizeof(Model));
}
FMI2_EXPORT void fmi2FreeInstance(fmi2Component c) {
  free(c);
}
FMI2_EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean has_tolerance, fmi2Real tolerance,
                                           fmi2Real start, fmi2Boolean has_stop, fmi2Real stop) {
  (void)c, (void)has_tolerance, (void)tolerance, (void)start, (void)has_stop, (void)stop;
  return fmi2OK;
}
FMI2_ANSWER(fmi2OK, fmi2EnterInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2ExitInitializationMode, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Terminate, fmi2Component)
FMI2_ANSWER(fmi2OK, fmi2Reset, fmi2Component)

FMI2_EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference r[], size_t n, fmi2String v[]) {
  Model* m = c;
  for (size_t i = 0; i < n; ++i) v[i] = r[i] == 0 ? m->targets : m->report;
  return fmi2OK;
}
FMI2_EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference r[], size_t n, const fmi2String v[]) {
  Model* m = c;
  for (size_t i = 0; i < n; ++i) {
    if (r[i] == 0) snprintf(m->targets, sizeof m->targets, "%s", v[i]);
  }
  return fmi2OK;
}
FMI2_NO_VALUES(Real)
FMI2_NO_VALUES(Integer)
FMI2_NO_VALUES(Boolean)

FMI2_EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real t, fmi2Real h, fmi2Boolean no_set_state) {
  (void)t, (void)h, (void)no_set_state;
  Model* m = c;
  if (m->report[0] == '\0') attack_all(m);
  return fmi2OK;
}
FMI2_NO_STATE
FMI2_NO_BYTES
FMI2_NO_DIRECTIONAL_DERIVATIVE
FMI2_NO_TIME_DERIVATIVES
FMI2_NO_PENDING_STEPS
FMI2_NO_REAL_STATUS
FMI2_NO_OTHER_STATUS
