/* Start of the program on a Cortex-M4F, and its way to say something. */

#include "check.h"

/* Where QEMU's loader puts the files. */
#define SLOT ((const uint8_t *)0x00100000)
#define SLOT_SIZE 4096
#define VECTORS ((const uint8_t *)0x00200000)

extern uint32_t stack_top, data_start, data_end, data_load, bss_start, bss_end;

static uint32_t semihosting(uint32_t operation, const void *argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
    return r0;
}

void say(const char *text)
{
    static uint32_t console;
    uint32_t length = 0;
    while (text[length])
        length++;
    if (!console) {
        /* SYS_OPEN of the standard output, for writing. */
        const uintptr_t open[3] = {(uintptr_t)":tt", 4, 3};
        console = semihosting(0x01, open);
    }
    const uintptr_t write[3] = {console, (uintptr_t)text, length};
    semihosting(0x05, write);
}

static void end(int failed)
{
    /* ADP_Stopped_ApplicationExit, or ADP_Stopped_RunTimeErrorUnknown. */
    semihosting(0x18, (const void *)(failed ? 0x20023u : 0x20026u));
    for (;;)
        ;
}

void reset(void)
{
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20; /* CPACR: the FPU */
    __asm__ volatile("dsb\n isb");
    const uint32_t *from = &data_load;
    for (uint32_t *to = &data_start; to < &data_end;)
        *to++ = *from++;
    for (uint32_t *to = &bss_start; to < &bss_end;)
        *to++ = 0;
    end(check(SLOT, SLOT_SIZE, VECTORS));
}

static void fault(void)
{
    say("FAILED: fault\n");
    end(1);
}

static const struct {
    const void *stack;
    void (*handlers[15])(void);
} vectors __attribute__((section(".vectors"), used)) = {
    &stack_top,
    {reset, fault, fault, fault, fault, fault},
};
