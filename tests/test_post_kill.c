/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-post, killed after each call by which it moves or removes a file: pad.xdmf always has its own data
 * beside it. */
#include "check.h"
#include "program_fixture.h"

#include "io/plain_file.h"
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

static bool moves_files(unsigned long long number) {
    static const unsigned long long calls[] = {
#ifdef SYS_rename
        SYS_rename,
#endif
#ifdef SYS_renameat
        SYS_renameat,
#endif
        SYS_renameat2,
#ifdef SYS_unlink
        SYS_unlink,
#endif
        SYS_unlinkat};
    for (size_t k = 0; k < sizeof calls / sizeof calls[0]; k++)
        if (calls[k] == number)
            return true;
    return false;
}

/* softfall-post of other.h5 into pair/, traced. */
static pid_t start(const program_place *p) {
    char program[1024];
    snprintf(program, sizeof program, "%s/softfall-post", getenv("SF_BIN_DIR"));
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setenv("ASAN_OPTIONS", "detect_leaks=0",
               1); /* the leak sanitizer does not work in a traced process */
        if (chdir(p->folder) != 0 || !freopen("log", "w", stdout) || !freopen("errors", "w", stderr) ||
            ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0)
            _exit(99);
        execl(program, "softfall-post", "other.h5", "-o", "pair", "--force", (char *)NULL);
        _exit(99);
    }
    return child;
}

/* Kills it behind its call number `last`, counted from 1. False: it has ended before. */
static bool run_and_kill(const program_place *p, int last) {
    int status = 0, count = 0;
    bool inside = false;
    pid_t child = start(p);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (!WIFSTOPPED(status))
        check_skip_refused("this process may trace no other (ptrace)");
    ptrace(PTRACE_SETOPTIONS, child, NULL, PTRACE_O_TRACESYSGOOD | PTRACE_O_EXITKILL);
    for (;;) {
        struct __ptrace_syscall_info info = {0};
        assert_int_equal(ptrace(PTRACE_SYSCALL, child, NULL, NULL), 0);
        assert_int_equal(waitpid(child, &status, 0), child);
        if (!WIFSTOPPED(status))
            break;
        if (WSTOPSIG(status) != (SIGTRAP | 0x80) ||
            ptrace(PTRACE_GET_SYSCALL_INFO, child, sizeof info, &info) <= 0)
            continue;
        if (info.op == PTRACE_SYSCALL_INFO_ENTRY)
            inside = moves_files(info.entry.nr);
        count += info.op == PTRACE_SYSCALL_INFO_EXIT && inside;
        if (count == last) {
            kill(child, SIGKILL);
            waitpid(child, &status, 0);
            return true;
        }
    }
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
    return false;
}

/* The data that pad.xdmf names are there, and are those that it was written with: their content has the hash
 * of their name. */
static void assert_pair(const program_place *p) {
    char path[1024];
    unsigned long long named = 0;
    uint64_t hash = 0;
    sf_error err = SF_ERROR_INIT;
    program_result name = program_shell(p, "grep -o 'pad-[0-9a-f]*.h5' pair/pad.xdmf | sort -u");
    name.out[strcspn(name.out, "\n")] = '\0';
    assert_int_equal(sscanf(name.out, "pad-%16llx.h5", &named), 1);
    snprintf(path, sizeof path, "%s/pair/%.40s", p->folder, name.out);
    if (sf_plain_hash(path, NULL, SF_PLAIN_ANY, &hash, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(hash == named);
    program_shell(p, "sed 's/pad-[0-9a-f]*/pad/' pair/pad.xdmf > now.xdmf");
    assert_int_equal(program_shell(p, "cmp now.xdmf one.xdmf || cmp now.xdmf other.xdmf").code, 0);
}

static void killed_between_two_moves_it_leaves_a_pair(void **state) {
    const program_place *p = *state;
    int moves = 1;
    program_succeed(p, "solve", "model.h5 -o other.h5 -t 1 --end-time '3 ms'");
    program_succeed(p, "post", "other.h5 -o pair");
    program_shell(p, "sed 's/pad-[0-9a-f]*/pad/' pair/pad.xdmf > other.xdmf; rm -r pair");
    program_succeed(p, "post", "results.h5 -o pair");
    program_shell(p, "sed 's/pad-[0-9a-f]*/pad/' pair/pad.xdmf > one.xdmf; cp -r pair first");
    for (; run_and_kill(p, moves); moves++) {
        assert_pair(p);
        program_shell(p, "rm -r pair; cp -r first pair");
    }
    print_message("killed after each of %d calls\n", moves - 1);
    assert_true(moves > 10);
    assert_pair(p);
    assert_int_equal(program_shell(p, "cmp now.xdmf other.xdmf && test $(ls pair/*.h5 | wc -l) = 1").code, 0);
}

/* The data of a run that was killed before it removed them are removed; not those that another .xdmf still
 * names, nor files that only have such a name. */
static void earlier_data_are_removed_and_other_files_are_not(void **state) {
    const program_place *p = *state;
    program_shell(p, "rm -rf pair kept left");
    program_succeed(p, "post", "other.h5 -o pair");
    program_succeed(p, "post", "other.h5 -o kept");
    program_shell(p, "mv kept/pad.xdmf kept/earlier.xdmf; cd pair; touch pad-0123456789abcdef.h5 pad-mine.h5 "
                     "pad-0123456789abcdef0.h5 pad-0123456789abcdef.h5.old; rm pad.xdmf");
    program_succeed(p, "post", "results.h5 -o pair --force");
    program_succeed(p, "post", "results.h5 -o kept --force");
    program_result list = program_shell(p, "cd pair; ls pad-0123* pad-mine.h5");
    assert_string_equal(
        list.out,
        "pad-0123456789abcdef.h5\npad-0123456789abcdef.h5.old\npad-0123456789abcdef0.h5\npad-mine.h5\n");
    assert_int_equal(program_shell(p, "ls pair/pad-????????????????.h5 | wc -l | grep -qx 2").code, 0);
    assert_int_equal(program_shell(p, "ls kept/pad-????????????????.h5 | wc -l | grep -qx 2").code, 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(killed_between_two_moves_it_leaves_a_pair),
        cmocka_unit_test(earlier_data_are_removed_and_other_files_are_not),
    };
    return cmocka_run_group_tests(tests, program_group_example, program_group_tear_down);
}
