/* Ends badly, each way of it. */
#include <avr/io.h>
#include <avr/interrupt.h>
#include <avr/sleep.h>

volatile uint8_t ticks;
ISR(TIMER0_OVF_vect) { ticks++; }

int main(void) {
#if WAY == 1
    cli();
    sleep_enable();
    sleep_cpu();
#elif WAY == 2
    __asm__ volatile(".word 0x9414\n"); /* no instruction */
#elif WAY == 3
    ((void (*)(void))0x3f00)(); /* erased flash */
#else
    /* Sleeps between overflows. */
    TCCR0B = _BV(CS00);
    TIMSK0 = _BV(TOIE0);
    sei();
    for (;;) sleep_mode();
#endif
    for (;;) {}
}
