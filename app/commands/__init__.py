"""The commands of ``hindsight`` that label and measure, one module each."""
