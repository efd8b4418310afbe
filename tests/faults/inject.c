// Runs a program and lets the N-th of its calls that change files below a folder fail, or kills it there.
//
//   inject FOLDER N ERRNO COMMAND...
//
// ERRNO 0 kills it; N 0 only counts. Standard error gets a line `fault: CALL PATH` there, and ends with one `calls: K`. The status is the
// program's, 128 and the signal where one ended it, 120 where nothing could be run.
//
// Calls are counted over all threads and whatever programs it becomes. They are caught in the kernel (seccomp and ptrace), for some
// libraries call it without libc.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

#define C(name) {SYS_##name, #name}
static const struct { int number; const char *name; } caught[] = {C(open), C(openat), C(creat), C(write), C(writev), C(pwrite64),
    C(pwritev), C(rename), C(renameat), C(renameat2), C(fsync), C(fdatasync), C(mkdir), C(mkdirat), C(ftruncate), C(linkat), C(link),
    C(copy_file_range), C(sendfile), C(unlink), C(unlinkat), C(rmdir)};
enum { KINDS = sizeof caught / sizeof *caught };

static const char *name_of(long number) {
    for (int i = 0; i < KINDS; i++)
        if (caught[i].number == number) return caught[i].name;
    return "?";
}

static void fail(const char *what) { perror(what); exit(120); }

static void filter(void) {
    struct sock_filter code[KINDS + 3];
    int k = 0;
    code[k++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (int i = 0; i < KINDS; i++) code[k++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, caught[i].number, KINDS - i, 0);
    code[k++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    code[k++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRACE);
    struct sock_fprog program = {k, code};
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) || prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program)) fail("seccomp");
}

// The text at an address of the process; empty where it can't be read.
static void text_at(pid_t pid, unsigned long at, char *into, size_t size) {
    size_t n = 0;
    while (n + 1 < size) {
        errno = 0;
        long word = ptrace(PTRACE_PEEKDATA, pid, at + n, 0);
        if (errno) break;
        for (size_t i = 0; i < sizeof word && n + 1 < size; i++, n++)
            if (!(into[n] = ((char *)&word)[i])) return;
    }
    into[n < size ? n : size - 1] = 0;
}

static void link_of(pid_t pid, const char *what, char *into) {
    char link[64];
    snprintf(link, sizeof link, "/proc/%d/%s", pid, what);
    ssize_t n = readlink(link, into, PATH_MAX - 1);
    into[n < 0 ? 0 : n] = 0;
}

// Whether a path, from the folder of a descriptor, or a descriptor itself (path 0), is below the folder.
static char whole[2 * PATH_MAX];
static int below(pid_t pid, const char *folder, int fd, unsigned long path) {
    static char name[PATH_MAX], base[PATH_MAX];
    char what[32];
    name[0] = 0;
    if (path) text_at(pid, path, name, sizeof name);
    if (name[0] == '/') {
        strcpy(whole, name);
    } else {
        if (fd == AT_FDCWD) strcpy(what, "cwd");
        else snprintf(what, sizeof what, "fd/%d", fd);
        link_of(pid, what, base);
        snprintf(whole, sizeof whole, name[0] ? "%s/%s" : "%s%s", base, name);
    }
    size_t n = strlen(folder);
    return !strncmp(whole, folder, n) && (whole[n] == '/' || !whole[n]);
}

static int counts(pid_t pid, const char *folder, const struct user_regs_struct *r) {
    int cwd = AT_FDCWD;
    switch (r->orig_rax) {
    case SYS_open: return (r->rsi & (O_ACCMODE | O_CREAT | O_TRUNC)) && below(pid, folder, cwd, r->rdi);
    case SYS_openat: return (r->rdx & (O_ACCMODE | O_CREAT | O_TRUNC)) && below(pid, folder, (int)r->rdi, r->rsi);
    case SYS_creat: case SYS_mkdir: case SYS_unlink: case SYS_rmdir: return below(pid, folder, cwd, r->rdi);
    case SYS_mkdirat: case SYS_unlinkat: return below(pid, folder, (int)r->rdi, r->rsi);
    case SYS_rename: case SYS_link: return below(pid, folder, cwd, r->rsi);
    case SYS_renameat: case SYS_renameat2: case SYS_linkat: return below(pid, folder, (int)r->rdx, r->r10);
    case SYS_copy_file_range: return below(pid, folder, (int)r->rdx, 0);
    default: return below(pid, folder, (int)r->rdi, 0);
    }
}

int main(int argc, char **argv) {
    if (argc < 5) return fputs("inject FOLDER N ERRNO COMMAND...\n", stderr), 120;
    const char *folder = argv[1];
    long nth = atol(argv[2]), error = atol(argv[3]), calls = 0;
    pid_t child = fork();
    if (child < 0) fail("fork");
    if (!child) {
        if (ptrace(PTRACE_TRACEME, 0, 0, 0)) fail("ptrace");
        raise(SIGSTOP);
        filter();
        execv(argv[4], argv + 4);
        fail(argv[4]);
    }
    int status;
    if (waitpid(child, &status, 0) != child) fail("waitpid");
    long options = PTRACE_O_EXITKILL | PTRACE_O_TRACESECCOMP | PTRACE_O_TRACECLONE | PTRACE_O_TRACEFORK | PTRACE_O_TRACEVFORK |
        PTRACE_O_TRACEEXEC;
    if (ptrace(PTRACE_SETOPTIONS, child, 0, options) || ptrace(PTRACE_CONT, child, 0, 0)) fail("ptrace");
    int answer = 120;
    for (;;) {
        pid_t pid = waitpid(-1, &status, __WALL);
        if (pid < 0) break;
        if (WIFEXITED(status) || WIFSIGNALED(status)) {
            if (pid == child) answer = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            continue;
        }
        int signal = 0, event = status >> 16;
        if (event == PTRACE_EVENT_SECCOMP) {
            struct user_regs_struct r;
            if (!ptrace(PTRACE_GETREGS, pid, 0, &r) && counts(pid, folder, &r) && ++calls == nth) {
                fprintf(stderr, "\nfault: %s %s\n", name_of(r.orig_rax), whole);
                if (!error) kill(child, SIGKILL);
                else {
                    r.orig_rax = -1;
                    r.rax = -error;
                    ptrace(PTRACE_SETREGS, pid, 0, &r);
                }
            }
        } else if (!event && WSTOPSIG(status) != SIGSTOP) signal = WSTOPSIG(status);
        ptrace(PTRACE_CONT, pid, 0, signal);
    }
    fprintf(stderr, "calls: %ld\n", calls);
    return answer;
}
