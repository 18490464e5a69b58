"""The REST API and the page: routes over the rest of StepRamp, without arithmetic of their own."""
