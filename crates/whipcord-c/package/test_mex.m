% The MEX example beside the example in C: the same bits, and errors as errors.
expected = load("tip.txt");
tip = whipcord_tip("two-segment-arm.toml");
assert(isequal(tip, expected));
again = whipcord_tip("two-segment-arm.toml", [14, 1, 1, 8, 1, 1]);
assert(isequal(again, expected));
assert(!isequal(whipcord_tip("two-segment-arm.toml", ones(1, 6)), expected));

function message = message_of(varargin)
  message = "";
  try
    whipcord_tip(varargin{:});
  catch problem
    message = problem.message;
  end
end

assert(!isempty(strfind(message_of("nothing.toml"), "nothing.toml")));
assert(!isempty(strfind(message_of("two-segment-arm.toml", [1, 2]), "length 2")));
assert(!isempty(strfind(message_of("two-segment-arm.toml", nan(1, 6)), "finite")));
assert(!isempty(strfind(message_of(), "whipcord_tip(file")));
assert(!isempty(strfind(message_of(1), "whipcord_tip(file")));
disp("the MEX example gives the same bits");
